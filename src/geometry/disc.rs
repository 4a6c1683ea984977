use super::{Point, Vector, cross};

/// Meeting of a moving disc with a point. The disc is centred at the origin and moves along the unit vector
/// `towards`. Returns the distance (m) until its centre is level with the point, and by how much (m) its rim
/// gets there earlier. `None` for points beside its path or behind its centre.
///
/// ```
/// use roverlab::geometry::{Point, Vector, meeting};
/// let (until, before) = meeting(&Point::new(1.0, 0.03), Vector::x(), 0.05).expect("it is in the way");
/// assert!(until == 1.0 && (before - 0.04).abs() < 1e-12, "3, 4, 5");
/// assert_eq!(meeting(&Point::new(1.0, 0.06), Vector::x(), 0.05), None);
/// ```
pub fn meeting(point: &Point, towards: Vector, radius: f64) -> Option<(f64, f64)> {
    let (along, across) = (point.coords.dot(&towards), cross(towards, point.coords));
    let depth = radius * radius - across * across;
    (along > 0.0 && depth > 0.0).then(|| (along, depth.sqrt()))
}

/// Distance (m) that the disc can move until it touches one of `points`, and that point; infinite and `None`
/// if its path is free. Negative for a point ahead that is already inside the disc. Linear in the number of
/// points.
///
/// ```
/// use roverlab::geometry::{Point, Vector, free_distance};
/// let points = [Point::new(1.0, 0.03), Point::new(2.0, 0.0), Point::new(-0.01, 0.0)];
/// let (free, touched) = free_distance(&points, Vector::x(), 0.05);
/// assert!((free - 0.96).abs() < 1e-12 && touched == Some(points[0]));
/// ```
pub fn free_distance(points: &[Point], towards: Vector, radius: f64) -> (f64, Option<Point>) {
    let mut free = (f64::INFINITY, None);
    for point in points {
        if let Some((along, before)) = meeting(point, towards, radius)
            && along - before < free.0
        {
            free = (along - before, Some(*point));
        }
    }
    free
}
