use crate::geometry::{Point, Pose};
use crate::io::LidarScan;
use crate::scan::{HEIGHT, ScanMatcher};
use crate::world::World;
use crate::world::space::{Scanner, Solid, Space};

/// Localisation in the known world: odometry, corrected by matching scans with expected ones.
#[derive(Debug, Clone)]
pub(super) struct Locator {
    space: Space,
    start: Pose,
    scanner: Option<Scanner>,
    expected: LidarScan,
    matcher: ScanMatcher,
    /// Pose of the expected scan, relative to the start.
    expected_at: Pose,
    points: Vec<Point>,
}

/// Distance driven between two expected scans (m).
const SPACING: f64 = 0.06;

impl Locator {
    pub(super) fn new(world: &World, start: Pose) -> Self {
        let mut space = Space::new(&world.walls);
        for object in &world.objects {
            space.add(Solid::from(object));
        }
        Self {
            space,
            start,
            scanner: None,
            expected: LidarScan::default(),
            matcher: ScanMatcher::new(),
            expected_at: Pose::default(),
            points: Vec::new(),
        }
    }

    /// The pose in the world at which a scan was taken.
    pub(super) fn locate(&mut self, odometry: Pose, scan: &LidarScan) -> Pose {
        self.points.clear();
        self.points.extend(scan.points());
        let pose = self.matcher.update(odometry, &self.points);
        let is_first = self.scanner.is_none();
        if is_first || pose.distance_to(self.expected_at.position()) > SPACING {
            self.expect(pose, scan);
        }
        self.start.compose(&pose)
    }

    /// Computes the scan expected in the known world from a pose relative to the start.
    fn expect(&mut self, pose: Pose, scan: &LidarScan) {
        let beams = scan.ranges.len();
        let scanner = self.scanner.get_or_insert_with(|| {
            Scanner::new(scan.angle_min, scan.angle_increment, beams, HEIGHT, 0.0, scan.range_max)
        });
        if scanner.beams() != beams {
            *scanner = Scanner::new(scan.angle_min, scan.angle_increment, beams, HEIGHT, 0.0, scan.range_max);
        }
        self.expected.clone_from(scan);
        let at = self.start.compose(&pose).compose(&scan.mount);
        self.space.scan(scanner, &at, None, &mut self.expected.ranges);
        self.points.clear();
        self.points.extend(self.expected.points());
        self.matcher.know(pose, &self.points);
        self.expected_at = pose;
    }
}
