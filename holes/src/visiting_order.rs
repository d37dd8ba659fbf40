//! The order in which points are visited: nearest neighbour, then 2-opt and Or-opt.
//!
//! On 100 000 random points the path is 8 % above the expected best, 0.7124 sqrt(n area). Lengths
//! are compared as floats. No coordinate is computed from them.

/// Number of neighbours of each point that are tried.
const NEIGHBOURS: usize = 8;
/// Longest piece of the path that is reversed. The limit bounds the time for very large boards.
const LONGEST_TURN: usize = 50_000;
/// Longest piece that is moved to another position of the path.
const LONGEST_MOVE: usize = 3;
/// Points in a cell of the grid, on average.
const CELL_POINTS: usize = 3;
/// A smaller gain, in nm, may be due to rounding.
const LEAST_GAIN: f64 = 0.5;

/// How the length of a path is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Metric {
    /// Both axes at once, in a straight line.
    Straight,
    /// One axis after the other, as the circuit-board drill moves.
    AxisByAxis,
}

/// Returns the indices of `points` in the order of a short path. The path begins at `start` and
/// ends anywhere. Equal input gives equal output. The cost is about n log n for points that are
/// spread out, and n^2 at worst.
pub fn shortest(points: &[[i64; 2]], start: [i64; 2], metric: Metric) -> Vec<usize> {
    let grid = Grid::new(points, start);
    // Points that are close together have close numbers, so that the data of neighbours is close in
    // memory, too.
    let places: Vec<[f64; 2]> = grid.order.iter().map(|&point| grid.points[point]).collect();
    let mut tour = Tour::new(&grid, &places, metric);
    tour.improve();
    let path = tour.path.iter().map(|&point| grid.order[point as usize]);
    path.skip(1).map(|point| point - 1).collect()
}

/// The length of the path from `start` through all points, in the unit of the points.
pub fn travel(points: impl IntoIterator<Item = [i64; 2]>, start: [i64; 2], metric: Metric) -> f64 {
    let mut from = start;
    points
        .into_iter()
        .map(|to| metric.distance(std::mem::replace(&mut from, to), to))
        .sum()
}

impl Metric {
    fn distance(self, [x0, y0]: [i64; 2], [x1, y1]: [i64; 2]) -> f64 {
        self.length((x1 - x0) as f64, (y1 - y0) as f64)
    }

    fn length(self, dx: f64, dy: f64) -> f64 {
        match self {
            Metric::Straight => (dx * dx + dy * dy).sqrt(),
            Metric::AxisByAxis => dx.abs() + dy.abs(),
        }
    }
}

/// The points, the start as number 0, in square cells.
struct Grid {
    points: Vec<[f64; 2]>,
    /// The points by cells, row after row, every other row backwards.
    order: Vec<usize>,
    /// Where each cell begins in `order`.
    begins: Vec<usize>,
    columns: usize,
    rows: usize,
    low: [f64; 2],
    side: f64,
}

impl Grid {
    fn new(points: &[[i64; 2]], start: [i64; 2]) -> Self {
        let points: Vec<_> = std::iter::once(&start)
            .chain(points)
            .map(|point| point.map(|nm| nm as f64))
            .collect();
        let reach = |axis: usize| {
            let values = points.iter().map(|point| point[axis]);
            values.fold([f64::MAX, f64::MIN], |[low, high], value| {
                [low.min(value), high.max(value)]
            })
        };
        let [[x, x_high], [y, y_high]] = [reach(0), reach(1)];
        let [width, height] = [x_high - x, y_high - y];
        let cells = (points.len() / CELL_POINTS).max(1) as f64;
        // A row of points has its cells in a row.
        let side = (width * height / cells)
            .sqrt()
            .max((width + height) / cells)
            .max(1.0);
        let count = |length: f64| (length / side) as usize + 1;
        let mut grid = Self {
            order: Vec::new(),
            begins: Vec::new(),
            columns: count(width),
            rows: count(height),
            low: [x, y],
            side,
            points,
        };
        let cells = grid.columns * grid.rows;
        let cell_of: Vec<usize> = grid
            .points
            .iter()
            .map(|&point| grid.cell(grid.column_row(point)))
            .collect();
        let mut begins = vec![0; cells + 1];
        for &cell in &cell_of {
            begins[cell + 1] += 1;
        }
        for cell in 0..cells {
            begins[cell + 1] += begins[cell];
        }
        let mut next = begins.clone();
        let mut order = vec![0; cell_of.len()];
        for (point, &cell) in cell_of.iter().enumerate() {
            order[next[cell]] = point;
            next[cell] += 1;
        }
        grid.order = order;
        grid.begins = begins;
        grid
    }

    fn column_row(&self, point: [f64; 2]) -> [usize; 2] {
        let of = |axis: usize| ((point[axis] - self.low[axis]) / self.side) as usize;
        [of(0), of(1)]
    }

    fn cell(&self, [column, row]: [usize; 2]) -> usize {
        let column = if row % 2 == 0 {
            column
        } else {
            self.columns - 1 - column
        };
        row * self.columns + column
    }

    /// The cells whose distance from a cell is `ring` columns or rows.
    fn ring(&self, [column, row]: [usize; 2], ring: usize) -> impl Iterator<Item = usize> + '_ {
        let rows = row.saturating_sub(ring)..=(row + ring).min(self.rows - 1);
        rows.flat_map(move |at| {
            let is_whole = at + ring == row || at == row + ring;
            let step = if is_whole { 1 } else { 2 * ring };
            let ends = (0..=2 * ring).step_by(step.max(1));
            ends.filter_map(move |offset| {
                let at_column = (column + offset).checked_sub(ring)?;
                (at_column < self.columns).then(|| self.cell([at_column, at]))
            })
        })
    }
}

/// A path over the points, which are numbered by cells.
struct Tour<'a> {
    places: &'a [[f64; 2]],
    metric: Metric,
    /// The nearest points of each, nearest first; `count` to each.
    neighbours: Vec<u32>,
    count: usize,
    path: Vec<u32>,
    /// Where each point is in the path.
    at: Vec<u32>,
}

impl<'a> Tour<'a> {
    /// The path of nearest neighbours from the start.
    fn new(grid: &Grid, places: &'a [[f64; 2]], metric: Metric) -> Self {
        let count = NEIGHBOURS.min(places.len() - 1);
        let mut tour = Self {
            places,
            metric,
            neighbours: Vec::with_capacity(count * places.len()),
            count,
            path: Vec::with_capacity(places.len()),
            at: vec![0; places.len()],
        };
        for point in 0..places.len() {
            tour.find_neighbours(grid, point);
        }
        // The start is number 0 of all points.
        let start = grid.order.iter().position(|&point| point == 0).unwrap_or(0);
        tour.visit_nearest(grid, start);
        for (at, &point) in (0..).zip(&tour.path) {
            tour.at[point as usize] = at;
        }
        tour
    }

    fn distance(&self, a: u32, b: u32) -> f64 {
        let ([x0, y0], [x1, y1]) = (self.places[a as usize], self.places[b as usize]);
        self.metric.length(x1 - x0, y1 - y0)
    }

    fn neighbours(&self, of: u32) -> &[u32] {
        &self.neighbours[of as usize * self.count..][..self.count]
    }

    fn find_neighbours(&mut self, grid: &Grid, of: usize) {
        let mut found = [(f64::MAX, u32::MAX); NEIGHBOURS];
        let found = &mut found[..self.count];
        let Some(last) = self.count.checked_sub(1) else {
            return;
        };
        let home = grid.column_row(self.places[of]);
        for ring in 0..=grid.columns.max(grid.rows) {
            // A point in this ring is at least this distance away.
            if found[last].0 <= (ring as f64 - 1.0) * grid.side {
                break;
            }
            for cell in grid.ring(home, ring) {
                for point in grid.begins[cell]..grid.begins[cell + 1] {
                    if point == of {
                        continue;
                    }
                    let far = self.distance(of as u32, point as u32);
                    if far < found[last].0 {
                        let place = found.partition_point(|(known, _)| *known <= far);
                        found[place..].rotate_right(1);
                        found[place] = (far, point as u32);
                    }
                }
            }
        }
        self.neighbours
            .extend(found.iter().map(|(_, point)| *point));
    }

    /// From each point to the nearest one that was not visited.
    fn visit_nearest(&mut self, grid: &Grid, start: usize) {
        let mut is_visited = vec![false; self.places.len()];
        // Points of each cell that were not visited: they come first in it.
        let mut open: Vec<u32> = (0..self.places.len() as u32).collect();
        let mut place: Vec<u32> = open.clone();
        let mut ends: Vec<usize> = grid.begins[1..].to_vec();
        let mut at = start as u32;
        loop {
            self.path.push(at);
            is_visited[at as usize] = true;
            let cell = grid.cell(grid.column_row(self.places[at as usize]));
            ends[cell] -= 1;
            let (hole, other) = (place[at as usize], open[ends[cell]]);
            open.swap(hole as usize, ends[cell]);
            place[other as usize] = hole;
            if self.path.len() == self.places.len() {
                return;
            }
            let known = self
                .neighbours(at)
                .iter()
                .find(|&&point| !is_visited[point as usize]);
            at = match known {
                Some(&point) => point,
                None => self.nearest_open(grid, at, &open, &ends),
            };
        }
    }

    fn nearest_open(&self, grid: &Grid, of: u32, open: &[u32], ends: &[usize]) -> u32 {
        let home = grid.column_row(self.places[of as usize]);
        let mut nearest = (f64::MAX, of);
        for ring in 0..=grid.columns.max(grid.rows) {
            if nearest.0 <= (ring as f64 - 1.0) * grid.side {
                break;
            }
            for cell in grid.ring(home, ring) {
                for &point in &open[grid.begins[cell]..ends[cell]] {
                    let far = self.distance(of, point);
                    if far < nearest.0 {
                        nearest = (far, point);
                    }
                }
            }
        }
        nearest.1
    }

    /// Reverses pieces of the path, and moves short pieces, as long as the path becomes shorter.
    /// The first point stays.
    fn improve(&mut self) {
        // Points whose neighbours on the path have changed since they were tried.
        let mut open: std::collections::VecDeque<u32> = self.path.iter().copied().collect();
        let mut is_open = vec![true; self.path.len()];
        while let Some(point) = open.pop_front() {
            is_open[point as usize] = false;
            while let Some(turns) = self.turn_of(point).or_else(|| self.move_of(point)) {
                for (low, high) in turns.into_iter().filter(|(low, high)| low < high) {
                    for end in [low.wrapping_sub(1), low, high, high + 1] {
                        if let Some(&end) = self.path.get(end) {
                            if !std::mem::replace(&mut is_open[end as usize], true) {
                                open.push_back(end);
                            }
                        }
                    }
                    self.turn(low, high);
                }
            }
        }
    }

    fn turn(&mut self, low: usize, high: usize) {
        self.path[low..=high].reverse();
        for (at, &point) in (low as u32..).zip(&self.path[low..=high]) {
            self.at[point as usize] = at;
        }
    }

    /// A piece `low..=high` of the path that is better reversed: one that brings `a` next to one of
    /// its neighbours.
    fn turn_of(&self, a: u32) -> Option<[(usize, usize); 3]> {
        let only = |low, high| Some([(low, high), (0, 0), (0, 0)]);
        let at = self.at[a as usize] as usize;
        let length = |from: u32, to: Option<&u32>| to.map_or(0.0, |&to| self.distance(from, to));
        // Exchanges the points after `a` and after its neighbour ...
        let behind = self.path.get(at + 1);
        let now = length(a, behind);
        for &c in self.neighbours(a) {
            let joined = self.distance(a, c);
            if joined >= now {
                break;
            }
            let place = self.at[c as usize] as usize;
            let other = self.path.get(place + 1);
            let crossed = match (behind, other) {
                (Some(&b), Some(&d)) => self.distance(b, d),
                _ => 0.0,
            };
            let (low, high) = (at.min(place) + 1, at.max(place));
            let gain = now + length(c, other) - joined - crossed;
            if gain > LEAST_GAIN && high - low < LONGEST_TURN {
                return only(low, high);
            }
        }
        // ... or the points before them. The first point of the path has no point before it.
        let before = *self.path.get(at.checked_sub(1)?)?;
        let now = self.distance(a, before);
        for &c in self.neighbours(a) {
            let joined = self.distance(a, c);
            if joined >= now {
                break;
            }
            let place = self.at[c as usize] as usize;
            let Some(&other) = place.checked_sub(1).and_then(|at| self.path.get(at)) else {
                continue;
            };
            let gain = now + self.distance(c, other) - joined - self.distance(before, other);
            let (low, high) = (at.min(place), at.max(place) - 1);
            if gain > LEAST_GAIN && high - low < LONGEST_TURN {
                return only(low, high);
            }
        }
        None
    }

    /// A piece of up to three points with `a` at an end that is better next to a neighbour of `a`,
    /// as reversals of the path.
    fn move_of(&self, a: u32) -> Option<[(usize, usize); 3]> {
        let at = self.at[a as usize] as usize;
        let point = |at: usize| self.path.get(at).copied();
        for length in 1..=LONGEST_MOVE {
            // `a` is the last point of the piece, or the first; the first point of the path stays.
            for (low, high) in [(at.wrapping_sub(length - 1), at), (at, at + length - 1)] {
                if low == 0 || low > at || high >= self.path.len() {
                    continue;
                }
                let (first, last) = (self.path[low], self.path[high]);
                let before = self.path[low - 1];
                let after = point(high + 1);
                let to = |from: u32, to: Option<u32>| to.map_or(0.0, |to| self.distance(from, to));
                let freed = self.distance(before, first) + to(last, after) - to(before, after);
                if freed <= LEAST_GAIN {
                    continue;
                }
                let other = if a == first { last } else { first };
                for &c in self.neighbours(a) {
                    let joined = self.distance(a, c);
                    if joined >= freed {
                        break;
                    }
                    let place = self.at[c as usize] as usize;
                    if (low..=high).contains(&place) {
                        continue;
                    }
                    // Behind `c`, or before it.
                    for left in [place, place.wrapping_sub(1)] {
                        // Between the point at `left` and the one after it, which are not next to
                        // the piece.
                        if left == high || left.wrapping_add(1) == low || left >= self.path.len() {
                            continue;
                        }
                        let (outer, is_behind) = if left == place {
                            (point(left + 1), true)
                        } else {
                            (point(left), false)
                        };
                        let paid = joined + to(other, outer) - to(c, outer);
                        let far = if left > high { left - low } else { high - left };
                        if freed - paid <= LEAST_GAIN || far > LONGEST_TURN {
                            continue;
                        }
                        // `a` comes next to `c`: it is first in the piece if the piece is after
                        // `c`.
                        let is_turned = (a == first) != is_behind;
                        return Some(moved(low, high, left, is_turned));
                    }
                }
            }
        }
        None
    }
}

/// The piece `low..=high` moved between the points at `left` and `left + 1`, reversed or not, as
/// three reversals.
fn moved(low: usize, high: usize, left: usize, is_turned: bool) -> [(usize, usize); 3] {
    let length = high + 1 - low;
    // Reverses everything from the piece to its new position, then each of the two parts.
    let (all, between, piece) = if left > high {
        ((low, left), (low, left - length), (left + 1 - length, left))
    } else {
        (
            (left + 1, high),
            (left + 1 + length, high),
            (left + 1, left + length),
        )
    };
    [all, between, if is_turned { (0, 0) } else { piece }]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn along(points: &[[i64; 2]], order: &[usize]) -> f64 {
        travel(
            order.iter().map(|&point| points[point]),
            [0; 2],
            Metric::Straight,
        )
    }

    /// All orders, for few points.
    fn best(points: &[[i64; 2]], from: [i64; 2], left: &mut Vec<usize>) -> f64 {
        let mut least = if left.is_empty() { 0.0 } else { f64::MAX };
        for turn in 0..left.len() {
            let point = left.remove(turn);
            let rest = best(points, points[point], left);
            least = least.min(Metric::Straight.distance(from, points[point]) + rest);
            left.insert(turn, point);
        }
        least
    }

    fn scattered(count: u64, seed: u64) -> Vec<[i64; 2]> {
        let mut state = seed;
        let mut next = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 40) as i64
        };
        (0..count).map(|_| [next(), next()]).collect()
    }

    /// The point nearest to 0, 0.
    fn nearest(points: &[[i64; 2]]) -> Option<usize> {
        let far = |point: usize| Metric::Straight.distance([0; 2], points[point]);
        (0..points.len()).min_by(|&a, &b| far(a).total_cmp(&far(b)))
    }

    /// Each neighbour list against all points.
    #[test]
    fn neighbours_are_the_nearest() {
        for (points, name) in [
            (scattered(500, 8), "scattered"),
            ((0..300).map(|x| [x * x, 0]).collect(), "a row"),
            (
                (0..300).map(|n| [n % 2 * 1_000_000, n / 2]).collect(),
                "two columns",
            ),
            (vec![[3, 3]; 50], "one place"),
        ] {
            for metric in [Metric::Straight, Metric::AxisByAxis] {
                let grid = Grid::new(&points, [0; 2]);
                let places: Vec<_> = grid.order.iter().map(|&point| grid.points[point]).collect();
                let tour = Tour::new(&grid, &places, metric);
                for of in 0..places.len() as u32 {
                    let all = (0..places.len() as u32).filter(|&other| other != of);
                    let mut far: Vec<f64> = all.map(|other| tour.distance(of, other)).collect();
                    far.sort_unstable_by(f64::total_cmp);
                    let found = tour
                        .neighbours(of)
                        .iter()
                        .map(|&other| tour.distance(of, other));
                    assert!(found.eq(far[..NEIGHBOURS].iter().copied()), "{name}");
                }
            }
        }
    }

    /// A piece moved by turns is where it should be.
    #[test]
    fn moves_are_turns() {
        for (low, high, left, is_turned, expected) in [
            (1, 2, 5, false, [0, 3, 4, 5, 1, 2, 6]),
            (1, 2, 5, true, [0, 3, 4, 5, 2, 1, 6]),
            (4, 5, 0, false, [0, 4, 5, 1, 2, 3, 6]),
            (4, 5, 0, true, [0, 5, 4, 1, 2, 3, 6]),
            (3, 3, 4, false, [0, 1, 2, 4, 3, 5, 6]),
            (2, 4, 6, true, [0, 1, 5, 6, 4, 3, 2]),
        ] {
            let mut path = [0, 1, 2, 3, 4, 5, 6];
            for (low, high) in moved(low, high, left, is_turned) {
                path[low..=high].reverse();
            }
            assert_eq!(path, expected);
        }
    }

    #[test]
    fn every_point_once_and_never_longer_than_nearest_neighbour() {
        for count in [0, 1, 2, 3, 10, 300] {
            let points = scattered(count, count + 1);
            let order = shortest(&points, [0; 2], Metric::Straight);
            let mut sorted = order.clone();
            sorted.sort_unstable();
            assert_eq!(sorted, (0..points.len()).collect::<Vec<_>>());
            let grid = Grid::new(&points, [0; 2]);
            let places: Vec<_> = grid.order.iter().map(|&point| grid.points[point]).collect();
            let first = Tour::new(&grid, &places, Metric::Straight).path;
            let first: Vec<_> = first[1..]
                .iter()
                .map(|&point| grid.order[point as usize] - 1)
                .collect();
            assert_eq!(first.first().copied(), nearest(&points));
            assert!(along(&points, &order) <= along(&points, &first) + 0.5);
        }
    }

    #[test]
    fn close_to_the_best_of_small_sets() {
        let (mut total, mut least) = (0.0, 0.0);
        for seed in 0..60 {
            let points = scattered(7, seed);
            total += along(&points, &shortest(&points, [0; 2], Metric::Straight));
            least += best(&points, [0; 2], &mut (0..7).collect());
        }
        assert!(total < 1.06 * least, "{}", total / least);
    }

    #[test]
    fn equal_points_and_rows() {
        let equal = vec![[5, 5]; 40];
        assert_eq!(shortest(&equal, [0; 2], Metric::Straight).len(), 40);
        let row: Vec<_> = (0..50).map(|x| [(x * 7 % 50) * 1000, 0]).collect();
        assert_eq!(
            along(&row, &shortest(&row, [0; 2], Metric::Straight)),
            49_000.0
        );
    }

    #[test]
    fn two_opt_leaves_no_crossing_that_its_neighbours_see() {
        let points = scattered(400, 3);
        let order = shortest(&points, [0; 2], Metric::Straight);
        // Random points of a square of side 2^24: about 0.7124 * sqrt(n * area) is the best tour.
        let tour = 0.7124 * (400.0_f64).sqrt() * f64::from(1 << 24);
        assert!(along(&points, &order) < 1.10 * tour);
    }
}
