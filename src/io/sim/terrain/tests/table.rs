//! The model against what is known of it, as a table.

use super::super::undercarriage::{Foot, Grip};
use super::*;
use crate::geometry::Vector3;

/// Half the length and half the width of a body's support (m).
const SUPPORT: [f64; 2] = [0.13, 0.09];
/// Height of a body's centre of mass (m).
const HEIGHT: f64 = 0.16;

/// A body on four feet, braked.
fn four_feet(friction: f64) -> Undercarriage {
    let [x, y] = SUPPORT;
    let corners = [(x, y), (x, -y), (-x, y), (-x, -y)];
    let feet = corners.map(|(x, y)| Foot::stiff(Vector3::new(x, y, 0.0), Grip::Driven(Vector::new(x, y)), 4));
    Undercarriage::new(feet.to_vec(), Vector3::new(0.0, 0.0, HEIGHT), 0.01, friction)
}

/// Whether the centre of mass is beyond an edge of the support, on a slope (degrees) at a heading.
fn is_beyond_support(heading: f64, degrees: f64) -> bool {
    let incline = math::tan(units::from_deg(degrees));
    // Headings are those of the map; on the slope, angles to the way uphill are smaller.
    let forward =
        Vector3::new(math::cos(heading), math::sin(heading), incline * math::cos(heading)).normalize();
    let uphill = Vector3::new(1.0, 0.0, incline).normalize();
    let left = uphill.cross(&Vector3::y()).cross(&forward);
    let [x, y] = [forward, left].map(|axis| HEIGHT * incline * axis.dot(&uphill).abs());
    x > SUPPORT[0] || y > SUPPORT[1]
}

/// Whether a body tips there.
fn tips(heading: f64, degrees: f64) -> bool {
    let ground = incline(degrees);
    let mut robot = Robot::with(four_feet(20.0), &ground, Pose::new(0.0, 0.0, heading));
    robot.run(&ground, PlanarTwist::STOP, 3.0);
    let normal = ground.normal(Point::origin()).unwrap();
    robot.pose().up().dot(&normal) < math::cos(0.1)
}

/// Evenly spaced headings.
fn headings(count: u32) -> impl Iterator<Item = f64> {
    (0..count).map(move |number| TAU * (f64::from(number) + 0.3) / f64::from(count))
}

/// Maximum error of the angle of slip over headings (degrees).
fn slip_error(count: u32) -> f64 {
    let cases = headings(count).flat_map(|heading| [0.3, 0.5].map(|friction| (heading, friction)));
    let errors = cases.map(|(heading, friction)| {
        (slips_at(&four_feet(friction), heading) - units::to_deg(math::atan(friction))).abs()
    });
    errors.fold(0.0, f64::max)
}

/// Maximum error of the angle of tipping over headings (degrees).
fn tip_error(count: u32) -> f64 {
    let errors = headings(count).map(|heading| {
        let geometry = threshold(|degrees| is_beyond_support(heading, degrees));
        (threshold(|degrees| tips(heading, degrees)) - geometry).abs()
    });
    errors.fold(0.0, f64::max)
}

#[test]
fn bodies_slip_at_every_heading_where_they_should() {
    let error = slip_error(5);
    assert!(error < 0.2, "{error}");
}

#[test]
fn bodies_tip_at_every_heading_where_they_should() {
    for heading in headings(12) {
        let geometry = threshold(|degrees| is_beyond_support(heading, degrees));
        assert!(!tips(heading, geometry - 0.5), "{heading}: tips below {geometry} degrees");
        assert!(tips(heading, geometry + 0.5), "{heading}: stands above {geometry} degrees");
    }
}

mod campaigns {
    use super::*;

    /// Prints what the model keeps.
    #[test]
    #[ignore = "takes minutes: cargo test --release --lib -- --ignored --nocapture physics_table"]
    fn physics_table() {
        println!("| slip against atan(mu), 36 headings | {:.2} degrees |", slip_error(36));
        println!("| tipping against geometry, 36 headings | {:.2} degrees |", tip_error(36));
        let (mut stream, robots) = (Stream::new(1), robots());
        let grounds: Vec<HeightField> = (0..199).map(|seed| hills(seed, 1.5)).collect();
        let mut wrong = 0;
        for start in 0..20_000_usize {
            let found = let_go(&grounds[start % grounds.len()], &robots[start % robots.len()], &mut stream);
            wrong += u32::from(found.is_err());
        }
        println!("| starts without motors that gain energy or sink in, of 20,000 | {wrong} |");
        for spec in &robots {
            let found = [3, 4].map(|seed| {
                let drive = PlanarTwist::new(0.25, 0.0, 0.15);
                apart(&ends(spec, &hills(seed, 0.2), Pose::new(0.0, -1.7, 0.0), drive, 40))
            });
            let far = found[0].0.max(found[1].0);
            let turned = found[0].1.max(found[1].1);
            println!(
                "| {}: end of 10 m at half the tick | {:.2} mm, {turned:.3} degrees |",
                spec.name,
                1000.0 * far
            );
        }
    }
}
