//! The frame of the coordinates of a routine.

use super::vector::{Vector, components, direction, dot, floats, minus, plus, scaled};
use husillo_probe::UnitVector;

/// A right-handed frame of the part. Lengths up to some metres are exact to below 1 nm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Its origin on the machine, nm.
    origin_nm: Vector,
    /// Directions of its X, Y and Z on the machine, of length 1.
    axes: [Vector; 3],
}

impl Frame {
    /// The frame of the machine.
    pub const MACHINE: Self = Self {
        origin_nm: [0.0; 3],
        axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };

    /// Creates the frame with these axes in which the point `at_nm` of the machine has the
    /// coordinates `called_nm`.
    pub fn new(axes: [Vector; 3], at_nm: Vector, called_nm: [i64; 3]) -> Self {
        let mut origin_nm = at_nm;
        for (axis, called) in axes.iter().zip(called_nm) {
            origin_nm = plus(origin_nm, scaled(*axis, -(called as f64)));
        }
        Self { origin_nm, axes }
    }

    /// The frame that is parallel to that of the machine, with this origin.
    pub fn shifted(origin_nm: [i64; 3]) -> Self {
        Self {
            origin_nm: floats(origin_nm),
            ..Self::MACHINE
        }
    }

    /// The frame with the same axes in which the point `at_nm` of the machine has the coordinate 0
    /// on each axis in `are_zero`. Its other coordinates do not change.
    pub fn zeroed(&self, at_nm: [i64; 3], are_zero: [bool; 3]) -> Self {
        let here = self.to_part(at_nm);
        let called = std::array::from_fn(|axis| if are_zero[axis] { 0 } else { here[axis] });
        Self::new(self.axes, floats(at_nm), called)
    }

    /// Converts a point of the part to the machine, rounded to the nearest nm.
    pub fn to_machine(self, part_nm: [i64; 3]) -> [i64; 3] {
        let mut sum = self.origin_nm;
        for (axis, along) in self.axes.iter().zip(part_nm) {
            sum = plus(sum, scaled(*axis, along as f64));
        }
        sum.map(|nm| nm.round() as i64)
    }

    /// Converts a point of the machine to the part, rounded to the nearest nm.
    pub fn to_part(self, machine_nm: [i64; 3]) -> [i64; 3] {
        let displacement = minus(floats(machine_nm), self.origin_nm);
        self.axes.map(|axis| dot(axis, displacement).round() as i64)
    }

    /// Converts a direction of the part to the machine. `None`: its length is 0.
    pub fn direction_to_machine(&self, part: Vector) -> Option<UnitVector> {
        let [x, y, z] = self.axes;
        let [a, b, c] = part;
        direction(plus(plus(scaled(x, a), scaled(y, b)), scaled(z, c)))
    }

    /// Converts a direction of the machine to the part.
    pub fn direction_to_part(&self, machine: &UnitVector) -> Vector {
        let machine = components(machine);
        self.axes.map(|axis| dot(axis, machine))
    }

    /// The direction of its Z on the machine.
    pub fn upright(&self) -> UnitVector {
        direction(self.axes[2]).unwrap_or(UnitVector::Z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn to_the_machine_and_back() {
        let x = [0.8, 0.6, 0.0];
        let y = [-0.6, 0.8, 0.0];
        let frame = Frame::new([x, y, [0.0, 0.0, 1.0]], [1e7, 2e7, 3e7], [500, 0, -7]);
        assert_eq!(
            frame.to_part([10_000_000, 20_000_000, 30_000_000]),
            [500, 0, -7]
        );
        let point = [123_456_789, -98_765_432, 5];
        assert_eq!(frame.to_part(frame.to_machine(point)), point);
        let zeroed = frame.zeroed(frame.to_machine(point), [true, false, true]);
        assert_eq!(zeroed.to_part(frame.to_machine(point)), [0, -98_765_432, 0]);
        let along = frame.direction_to_machine([1.0, 0.0, 0.0]).unwrap();
        assert_eq!(along.scaled(5_000_000), [4_000_000, 3_000_000, 0]);
    }
}
