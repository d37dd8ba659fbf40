//! Tests of features on points with known positions.

use husillo_probe::{Circle, FitError, Line, Middle, Plane, Sphere, UnitVector, corner_nm};

const MM: i64 = 1_000_000;

fn up() -> UnitVector {
    UnitVector::Z
}

#[test]
fn plane_of_a_tilted_face() {
    // z = 0.2 x - 0.1 y + 7 mm, far from the origin, with one of five points off by 30 um.
    let at = |x: i64, y: i64| [x + 400 * MM, y - 300 * MM, x / 5 - y / 10 + 7 * MM];
    let corners = [(0, 0), (50, 0), (50, 40), (0, 40)].map(|(x, y)| at(x * MM, y * MM));
    let plane = Plane::fit(corners, &up()).unwrap();
    let normal = UnitVector::new([-2, 1, 10]).unwrap();
    assert!((plane.normal.cosine(&normal).to_num::<f64>() - 1.0).abs() < 3e-9);
    assert_eq!(plane.residuals.form_nm, 0);
    assert_eq!(plane.distance_nm(at(123 * MM, -77 * MM)), 0);
    // A unit of distance is 1.025 units of height.
    assert_eq!(
        plane.distance_nm([plane.point_nm[0], plane.point_nm[1], plane.point_nm[2] + MM]),
        975_900
    );
    assert_eq!(
        plane.moved_nm(-2 * MM).distance_nm(plane.point_nm),
        2 * MM,
        "from centres of the ball to the surface"
    );
    let down = Plane::fit(corners, &up().reversed()).unwrap();
    assert_eq!(down.normal, plane.normal.reversed());

    let mut middle = at(25 * MM, 20 * MM);
    (0..3).for_each(|axis| middle[axis] += [-10_000, 5_000, 50_000][axis]);
    let five = Plane::fit(corners.into_iter().chain([middle]), &up()).unwrap();
    // The point is off by 51235 nm along the normal. By symmetry the plane moves up by a fifth of
    // it.
    assert_eq!(
        (
            five.residuals.points,
            five.residuals.largest_nm,
            five.residuals.form_nm
        ),
        (5, 40_988, 51_235)
    );
    assert_eq!(five.residuals.rms_nm, 20_494);
}

#[test]
fn edges_and_their_corner() {
    // Two edges of a part turned by atan(3/4), touched at different heights, and its top.
    let along = |t: i64, z: i64| [80 * MM + 4 * t, 20 * MM + 3 * t, z];
    let across = |t: i64, z: i64| [80 * MM - 3 * t, 20 * MM + 4 * t, z];
    let front = Plane::edge(
        [along(5 * MM, -MM), along(20 * MM, -3 * MM)],
        &up(),
        &UnitVector::Y.reversed(),
    )
    .unwrap();
    let side = Plane::edge(
        [
            across(4 * MM, -MM),
            across(9 * MM, -2 * MM),
            across(12 * MM, -MM),
        ],
        &up(),
        &UnitVector::X.reversed(),
    )
    .unwrap();
    let top = Plane::across([[0, 0, 10], [5, 5, 14]], &up()).unwrap();
    assert_eq!(top.point_nm[2], 12);
    assert_eq!((top.residuals.largest_nm, top.residuals.rms_nm), (2, 2));
    let corner = corner_nm(&front, &side, &top).unwrap();
    for (found, true_) in corner.iter().zip([80 * MM, 20 * MM, 12]) {
        assert!((found - true_).abs() <= 1, "{corner:?}");
    }
    assert!(front.normal.cosine(&side.normal).to_num::<f64>().abs() < 3e-9);
    assert_eq!(corner_nm(&front, &front, &top), None);

    let front = Line::fit([along(5 * MM, 0), along(20 * MM, 0)], &UnitVector::X).unwrap();
    let side = Line::fit([across(4 * MM, 0), across(9 * MM, 0)], &UnitVector::Y).unwrap();
    let corner = front.crossing_nm(&side).unwrap();
    for (found, true_) in corner.iter().zip([80 * MM, 20 * MM, 0]) {
        assert!((found - true_).abs() <= 1, "{corner:?}");
    }
    assert_eq!(front.crossing_nm(&front), None);
    assert_eq!(front.distance_nm(across(10 * MM, 0)), 50 * MM);
}

#[test]
fn line_of_three() {
    let line = Line::fit([[0, 0, 0], [10 * MM, 3_000, 0], [20 * MM, 0, 0]], &up()).unwrap();
    assert_eq!(line.point_nm, [10 * MM, 1_000, 0]);
    assert_eq!(
        (line.residuals.largest_nm, line.residuals.form_nm),
        (2_000, 2_000)
    );
    assert_eq!(line.direction.components()[0].to_num::<f64>().abs(), 1.0);
}

#[test]
fn web_and_pocket() {
    let middle = Middle::of([3 * MM, 1, 2], [-MM, 4, 2], &UnitVector::X);
    assert_eq!((middle.centre_nm, middle.width_nm), ([MM, 2, 2], 4 * MM));
}

#[test]
fn bore_and_boss() {
    // Pythagorean points of a circle with a radius of 65 mm, exact in nm. As centres of a ball of 1
    // mm they give a bore with a radius of 66 mm.
    let points = [(63, 16), (-63, 16), (16, -63), (-52, -39), (33, 56)]
        .map(|(x, y)| [500 * MM + x * MM, -200 * MM + y * MM, (x - y) * 1000]);
    let circle = Circle::fit(points, &up()).unwrap();
    assert_eq!(circle.centre_nm[..2], [500 * MM, -200 * MM]);
    assert_eq!((circle.radius_nm, circle.residuals.form_nm), (65 * MM, 0));
    assert_eq!(circle.grown_nm(MM).radius_nm, 66 * MM);
    assert_eq!(circle.distance_nm([500 * MM, -199 * MM, 7]), -64 * MM);

    // Oblique: the same points in a turned plane. A fitted plane gives the axis.
    let axis = [2, 3, 6];
    let (u, v) = ([3, -6, 2], [6, 2, -3]); // at right angles, all of length 7
    let turned = points.map(|[x, y, _]| {
        let (x, y) = (x - 500 * MM, y + 200 * MM);
        [0, 1, 2].map(|i| 100 * MM + x * u[i] + y * v[i] + axis[i])
    });
    let plane = Plane::fit(turned, &UnitVector::new(axis).unwrap()).unwrap();
    let circle = Circle::fit(turned, &plane.normal).unwrap();
    assert_eq!(circle.radius_nm, 7 * 65 * MM);
    for (found, axis) in circle.centre_nm.iter().zip(axis) {
        assert!(
            (found - 100 * MM - axis).abs() <= 1,
            "{:?}",
            circle.centre_nm
        );
    }
}

#[test]
fn spheres() {
    // Points of a sphere of 7 mm with whole coordinates, on its upper half.
    let points = [
        [2, 3, 6],
        [-3, 6, 2],
        [6, -2, 3],
        [-2, -6, 3],
        [0, 0, 7],
        [-6, -3, 2],
    ]
    .map(|p| p.map(|c| c * MM + 900 * MM));
    let sphere = Sphere::fit(points).unwrap();
    assert_eq!(
        (sphere.centre_nm, sphere.radius_nm),
        ([900 * MM; 3], 7 * MM)
    );
    assert_eq!(sphere.residuals.form_nm, 0);
    assert_eq!(sphere.distance_nm([900 * MM; 3]), -7 * MM);

    // The least-squares radius is the mean distance: shifts of +-300 nm in opposite pairs leave
    // centre and radius.
    let paired = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
        .into_iter()
        .zip([300, -300, 0])
        .flat_map(|(axis, off)| [1, -1].map(|sign| axis.map(|c| c * sign * (5 * MM + off))));
    let sphere = Sphere::fit(paired).unwrap();
    assert_eq!((sphere.centre_nm, sphere.radius_nm), ([0; 3], 5 * MM));
    assert_eq!(
        (
            sphere.residuals.largest_nm,
            sphere.residuals.form_nm,
            sphere.residuals.rms_nm
        ),
        (300, 600, 245)
    );
}

#[test]
fn what_points_do_not_determine_is_refused() {
    let line = [0, 1, 2, 3].map(|t| [t * MM, 2 * t * MM, -t * MM]);
    let plane = [[0, 0, 0], [MM, 0, 0], [MM, MM, 0], [0, 2 * MM, 0]];
    let point = [[5, 5, 5]; 4];
    assert_eq!(Plane::fit(line, &up()), Err(FitError::Undetermined));
    assert_eq!(Plane::fit([[0; 3]; 2], &up()), Err(FitError::TooFewPoints));
    assert_eq!(
        Plane::edge([[0, 0, 0], [0, 0, MM]], &up(), &up()),
        Err(FitError::Undetermined)
    );
    assert_eq!(Plane::across([], &up()), Err(FitError::TooFewPoints));
    assert_eq!(Line::fit(point, &up()), Err(FitError::Undetermined));
    assert_eq!(Line::fit([[0; 3]], &up()), Err(FitError::TooFewPoints));
    assert_eq!(Circle::fit(line, &up()), Err(FitError::Undetermined));
    assert_eq!(Circle::fit(point, &up()), Err(FitError::Undetermined));
    assert_eq!(Sphere::fit(plane), Err(FitError::Undetermined));
    assert_eq!(Sphere::fit(point), Err(FitError::Undetermined));
    assert_eq!(
        Sphere::fit(plane.into_iter().take(3)),
        Err(FitError::TooFewPoints)
    );
    let far = [
        [i64::MAX; 3],
        [i64::MIN; 3],
        [0, i64::MAX, 0],
        [7, 7, i64::MIN],
        [0; 3],
    ];
    let _ = (
        Sphere::fit(far),
        Plane::fit(far, &up()),
        Line::fit(far, &up()),
    );
}
