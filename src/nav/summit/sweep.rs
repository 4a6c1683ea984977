use crate::geometry::{Point3, Pose3, Vector3, direction, math, units};
use crate::io::{Attitude, LidarScan};

/// The tilts of the scans of a look around, in degrees: the nearer to level, the closer together, as ground far away shows
/// little of itself.
const TILTS: [f64; 24] = [
    -60.0, -48.0, -39.0, -32.0, -26.0, -21.5, -18.0, -15.0, -12.5, -10.5, -9.0, -7.5, -6.3, -5.2, -4.2, -3.2,
    -2.2, -1.2, 0.0, 2.0, 5.0, 9.0, 14.0, 20.0,
];

/// Scans at many tilts from one place, with the attitude in the meantime.
#[derive(Debug, Clone, Default)]
pub(super) struct Sweep {
    /// By tilt and then by beam: unit directions in the robot's frame, and metres.
    rings: Vec<Vec<(Vector3, f64)>>,
    attitudes: Vec<Attitude>,
}

/// A beam in the map's frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Beam {
    pub(super) origin: Point3,
    pub(super) direction: Vector3,
    /// Infinite without a return.
    pub(super) range: f64,
}

impl Beam {
    pub(super) fn end(&self) -> Option<Point3> {
        self.range.is_finite().then(|| self.origin + self.direction * self.range)
    }
}

impl Sweep {
    /// The tilt of the next scan, in radians; `None` once it is complete.
    pub(super) fn next_tilt(&self) -> Option<f64> {
        TILTS.get(self.rings.len()).map(|&degrees| units::from_deg(degrees))
    }

    /// Adds the scan of the tilt that is next.
    pub(super) fn add(&mut self, lidar: &Pose3, scan: &LidarScan, attitude: Attitude) {
        let Some(tilt) = self.next_tilt() else { return };
        let (rise, run) = math::sin_cos(tilt);
        let beam = |(index, &range): (usize, &f64)| {
            let flat = direction(scan.angle(index));
            (lidar.rotate(Vector3::new(flat.x * run, flat.y * run, rise)), range)
        };
        self.rings.push(scan.ranges.iter().enumerate().map(beam).collect());
        self.attitudes.push(attitude);
    }

    /// The mean attitude.
    pub(super) fn attitude(&self) -> Attitude {
        let count = self.attitudes.len().max(1) as f64;
        let mean = |of: fn(&Attitude) -> f64| self.attitudes.iter().map(of).sum::<f64>() / count;
        Attitude { roll: mean(|a| a.roll), pitch: mean(|a| a.pitch), yaw: 0.0 }
    }

    /// The beams of each azimuth, from the lowest tilt up, as seen from a robot in the map's frame.
    pub(super) fn fans<'s>(
        &'s self,
        robot: &'s Pose3,
        lidar: &Pose3,
    ) -> impl Iterator<Item = impl Iterator<Item = Beam> + 's> + 's {
        let origin = robot.to_world(lidar.position);
        let beams = self.rings.iter().map(Vec::len).min().unwrap_or(0);
        (0..beams).map(move |index| {
            self.rings.iter().map(move |ring| {
                let (own, range) = ring[index];
                Beam { origin, direction: robot.rotate(own), range }
            })
        })
    }
}
