//! What the low lidar of a car sees: cones as discs, cars as rectangles.

use super::world::{Obstacle, Race};
use crate::geometry::{Point, Pose, Vector, cross, direction, math};
use crate::io::LidarScan;

/// Metres that the lidar sees.
pub(super) const RANGE: f64 = 25.0;
/// A cone's radius at the height of the lidar, as a share of that of its foot.
const AT_HEIGHT: f64 = 0.5;
/// The foot of a cone that is none.
const PHANTOM: f64 = 0.129;

impl Race {
    /// Takes a scan from the nose of a car.
    pub(super) fn look(&mut self, index: usize, scan: &mut LidarScan) {
        let car = &self.cars[index];
        let (angle_min, angle_increment) = car.scanner.beams();
        let mount = Pose::new(car.spec.nose, 0.0, 0.0);
        let eye = car.body.pose(&car.spec).compose(&mount);
        scan.angle_min = angle_min;
        scan.angle_increment = angle_increment;
        scan.range_max = RANGE;
        scan.mount = mount;
        scan.ranges.clear();
        scan.ranges.resize(car.scanner.points, f64::INFINITY);
        let mut random = self.cars[index].lidar.clone();
        let mut seen = 0;
        for Obstacle { cone, .. } in self.cones.iter().filter(|cone| cone.stands) {
            let radius = AT_HEIGHT * cone.radius;
            let away = cone.position - eye.position();
            if away.norm_squared() > RANGE * RANGE || away.norm_squared() < radius * radius {
                continue;
            }
            let local = eye.to_local(cone.position);
            if local.x < -radius {
                continue;
            }
            let missed = self.options.missed > 0.0 && random.chance(self.options.missed);
            if !missed {
                seen += 1;
                disc(scan, local, radius);
            }
        }
        for other in (0..self.cars.len()).filter(|&other| other != index) {
            let corners = self.cars[other].corners().map(|corner| eye.to_local(corner));
            if corners.iter().all(|corner| corner.coords.norm() > RANGE) {
                continue;
            }
            for k in 0..4 {
                wall(scan, corners[k], corners[(k + 1) % 4]);
            }
        }
        if self.options.phantoms > 0.0 {
            for _ in 0..seen {
                if random.chance(self.options.phantoms) {
                    let (angle, range) = (random.between(-1.5, 1.5), random.between(2.0, 15.0));
                    disc(scan, Point::origin() + direction(angle) * range, AT_HEIGHT * PHANTOM);
                }
            }
        }
        let error = self.options.noise.range;
        if error > 0.0 {
            for range in scan.ranges.iter_mut().filter(|range| range.is_finite()) {
                *range = (*range + error * random.normal()).max(0.0);
            }
        }
        self.cars[index].lidar = random;
    }
}

/// The beams between two directions, as far as the scan has them.
fn beams(scan: &LidarScan, from: f64, to: f64) -> std::ops::Range<usize> {
    let place = |angle: f64| (angle - scan.angle_min) / scan.angle_increment;
    let first = place(from).ceil().max(0.0) as usize;
    let last = (place(to).floor() + 1.0).max(0.0) as usize;
    first..last.min(scan.ranges.len()).max(first)
}

fn disc(scan: &mut LidarScan, centre: Point, radius: f64) {
    let distance = centre.coords.norm();
    let (middle, half) = (math::atan2(centre.y, centre.x), math::asin((radius / distance).min(1.0)));
    for beam in beams(scan, middle - half, middle + half) {
        let offset = math::sin(scan.angle(beam) - middle) * distance;
        let depth = (radius * radius - offset * offset).max(0.0).sqrt();
        let along = (distance * distance - offset * offset).max(0.0).sqrt();
        let range = along - depth;
        if range < scan.ranges[beam] && range > 0.0 && range <= scan.range_max {
            scan.ranges[beam] = range;
        }
    }
}

fn wall(scan: &mut LidarScan, a: Point, b: Point) {
    let (first, second) = (math::atan2(a.y, a.x), math::atan2(b.y, b.x));
    // Behind the scanner the angle leaps: nothing there is seen anyway.
    if (first - second).abs() > std::f64::consts::PI {
        return;
    }
    for beam in beams(scan, first.min(second), first.max(second)) {
        let ray: Vector = direction(scan.angle(beam));
        let turned = cross(ray, b - a);
        if turned.abs() < 1e-12 {
            continue;
        }
        let range = cross(a.coords, b - a) / turned;
        if range > 0.0 && range < scan.ranges[beam] && range <= scan.range_max {
            scan.ranges[beam] = range;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::Lidar;
    use crate::io::sim::NoiseModel;
    use crate::io::sim::race::{RaceCarSpec, RaceCone, RaceOptions};
    use crate::world::Colour;

    /// Of many scans of one cone straight ahead, the share that shows it, and the share that shows something elsewhere.
    fn shares(missed: f64, phantoms: f64) -> (f64, f64) {
        const SCANS: usize = 2000;
        let cone = RaceCone::new(Point::new(10.0, 0.0), Colour::BLUE);
        let options = RaceOptions { noise: NoiseModel::ideal(), missed, phantoms, ..RaceOptions::default() };
        let cars = [(RaceCarSpec::default(), Pose::default())];
        let mut race = Race::new(&[cone], &cars, options).unwrap();
        let mut scan = LidarScan::default();
        let (mut seen, mut elsewhere) = (0, 0);
        for _ in 0..SCANS {
            race.car(0).unwrap().scan_into(&mut scan).unwrap();
            let hits = || scan.ranges.iter().enumerate().filter(|(_, range)| range.is_finite());
            seen += usize::from(hits().any(|(beam, _)| scan.angle(beam).abs() < 0.01));
            elsewhere += usize::from(hits().any(|(beam, _)| scan.angle(beam).abs() > 0.05));
        }
        (seen as f64 / SCANS as f64, elsewhere as f64 / SCANS as f64)
    }

    #[test]
    fn cones_are_missed_and_phantoms_are_seen() {
        assert_eq!(shares(0.0, 0.0), (1.0, 0.0));
        assert_eq!(shares(1.0, 1.0), (0.0, 0.0));
        let (seen, elsewhere) = shares(0.3, 0.0);
        assert!((seen - 0.7).abs() < 0.05 && elsewhere == 0.0, "{seen} {elsewhere}");
        // A few phantoms are before or beside the cone.
        let (seen, elsewhere) = shares(0.0, 0.4);
        assert!(seen == 1.0 && (elsewhere - 0.4).abs() < 0.06, "{seen} {elsewhere}");
    }
}
