//! Touch probe whose stylus bends before the contact closes.

use crate::work_piece::{PointMm, WorkPiece};

/// Parameters of a touch probe.
///
/// The ball does not stick: the surface deflects it along its normal, and the contact closes at the
/// trigger force. The deflection is the force divided by the stiffness of the stylus. The three
/// supports of the usual probe make the deflection a function of the direction in XY with three
/// lobes; along Z the stylus is stiff.
///
/// # Source
/// F. M. M. Chan, E. J. Davis, T. G. King, K. J. Stout, "Some performance characteristics of a
/// multi-axis touch trigger probe", Measurement Science and Technology 8, 1997.
#[derive(Copy, Clone, PartialEq, Debug)]
pub struct TouchProbeModel {
    /// Radius of the ball, mm.
    pub ball_radius_mm: f64,
    /// Deflection from touch to signal perpendicular to the stylus, mean of all directions, mm.
    pub bend_mm: f64,
    /// By this length, in mm, the deflection is larger in the directions 0, 120 and 240 degrees
    /// from X, and smaller between them.
    pub lobes_mm: f64,
    /// Deflection along the stylus (Z), mm.
    pub axial_mm: f64,
    /// Standard deviation of one touch, mm.
    pub noise_mm: f64,
}

impl TouchProbeModel {
    /// Deflection from touch to signal where the surface pushes along the unit vector `normal`, mm.
    pub fn pre_travel_mm(&self, normal: PointMm) -> f64 {
        let [x, y, z] = normal;
        // The stylus is deflected in the opposite direction.
        let angle = (-y).atan2(-x);
        let across = self.bend_mm + self.lobes_mm * (3.0 * angle).cos();
        (x * x + y * y) * across + z * z * self.axial_mm
    }
}

/// A simulated probe with its contact.
///
/// # Examples
/// ```
/// use husillo_sim::{Shape, Solid, TouchProbe, TouchProbeModel, WorkPiece};
///
/// let shape = Shape::Plane { point_mm: [10.0, 0.0, 0.0], outward: [-1.0, 0.0, 0.0] };
/// let piece = WorkPiece { solids: vec![Solid { shape, bores: vec![] }], ..WorkPiece::default() };
/// let model = TouchProbeModel {
///     ball_radius_mm: 1.0,
///     bend_mm: 0.008,
///     lobes_mm: 0.002,
///     axial_mm: 0.001,
///     noise_mm: 0.0,
/// };
/// let mut probe = TouchProbe::new(model, 1);
/// assert!(!probe.is_closed(&piece, [9.009, 0.0, 0.0])); // touching for 9 um
/// assert!(probe.is_closed(&piece, [9.011, 0.0, 0.0])); // a lobe: 10 um
/// ```
#[derive(Clone, Debug)]
pub struct TouchProbe {
    model: TouchProbeModel,
    /// Noise of the present or the next touch.
    noise_mm: f64,
    has_touched: bool,
    random: u64,
}

impl TouchProbe {
    /// Creates a probe without contact. The same seed gives the same noise.
    pub fn new(model: TouchProbeModel, seed: u64) -> TouchProbe {
        let mut probe = TouchProbe {
            model,
            noise_mm: 0.0,
            has_touched: false,
            random: seed,
        };
        probe.noise_mm = probe.normal_deviate() * model.noise_mm;
        probe
    }

    /// The parameters of the probe.
    pub fn model(&self) -> &TouchProbeModel {
        &self.model
    }

    /// Whether the contact is closed with the centre of the undeflected ball at `centre`.
    pub fn is_closed(&mut self, piece: &WorkPiece, centre: PointMm) -> bool {
        let bent_mm = self.model.ball_radius_mm - piece.distance_mm(centre);
        if bent_mm <= 0.0 {
            if self.has_touched {
                self.noise_mm = self.normal_deviate() * self.model.noise_mm;
            }
            self.has_touched = false;
            return false;
        }
        self.has_touched = true;
        let pre_travel_mm = self.model.pre_travel_mm(piece.normal(centre));
        bent_mm >= pre_travel_mm + self.noise_mm
    }

    /// A random number of mean 0 and standard deviation 1 (G. E. P. Box, M. E. Muller, "A note on
    /// the generation of random normal deviates", 1958).
    fn normal_deviate(&mut self) -> f64 {
        // Above 0, so that the logarithm exists.
        let [radius, angle] =
            [0; 2].map(|_| ((self.next() >> 11) + 1) as f64 / (1_u64 << 53) as f64);
        (-2.0 * radius.ln()).sqrt() * (std::f64::consts::TAU * angle).cos()
    }

    /// SplitMix64 (G. L. Steele, D. Lea, C. H. Flood, "Fast splittable pseudorandom number
    /// generators", 2014).
    fn next(&mut self) -> u64 {
        self.random = self.random.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.random;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::work_piece::{Shape, Solid};

    const MODEL: TouchProbeModel = TouchProbeModel {
        ball_radius_mm: 1.0,
        bend_mm: 0.008,
        lobes_mm: 0.002,
        axial_mm: 0.001,
        noise_mm: 0.0,
    };

    #[test]
    fn three_lobes_across_and_stiff_along() {
        let degrees = |degrees: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            MODEL.pre_travel_mm([-cos, -sin, 0.0])
        };
        for (angle, wanted) in [(0.0, 0.010), (120.0, 0.010), (60.0, 0.006), (30.0, 0.008)] {
            assert!((degrees(angle) - wanted).abs() < 1e-12, "{angle}");
        }
        assert_eq!(MODEL.pre_travel_mm([0.0, 0.0, 1.0]), 0.001);
    }

    #[test]
    fn noise_is_of_each_touch_and_as_large_as_said() {
        let shape = Shape::Plane {
            point_mm: [0.0; 3],
            outward: [0.0, 0.0, 1.0],
        };
        let piece = WorkPiece {
            solids: vec![Solid {
                shape,
                bores: Vec::new(),
            }],
            ..WorkPiece::default()
        };
        let model = TouchProbeModel {
            noise_mm: 0.0005,
            axial_mm: 0.01,
            ..MODEL
        };
        let mut probe = TouchProbe::new(model, 7);
        let mut touches = Vec::new();
        for _ in 0..2000 {
            assert!(!probe.is_closed(&piece, [0.0, 0.0, 1.1]));
            // Steps of 20 nm.
            let steps = 0..1000_i32;
            let height = |step: &i32| 1.0 - f64::from(*step) * 2e-5;
            let first = steps
                .clone()
                .find(|step| probe.is_closed(&piece, [0.0, 0.0, height(step)]))
                .unwrap();
            // Closed from there on.
            assert!(probe.is_closed(&piece, [0.0, 0.0, height(&(first + 1))]));
            touches.push(1.0 - height(&first));
        }
        let mean = touches.iter().sum::<f64>() / 2000.0;
        let square: f64 = touches.iter().map(|touch| (touch - mean).powi(2)).sum();
        let deviation = (square / 2000.0).sqrt();
        assert!((mean - 0.01).abs() < 5e-5, "{mean}");
        assert!((deviation - 0.0005).abs() < 3e-5, "{deviation}");
    }
}
