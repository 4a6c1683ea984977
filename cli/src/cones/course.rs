//! Race courses: from a file, or generated.

use std::path::Path;

use roverlab::geometry::{Aabb, Point, Pose, math};
use roverlab::io::Resolution;
use roverlab::race::{
    CarOutline, CentreLine, Cone, ConeColour, ConeTrack, Corridor, Event, EventCourse, GeneratedTrack,
    LaneParameters, RacerParameters, TrackFile, TrackOptions, generate, lined, parse_track,
};
use roverlab::random::Stream;
use roverlab::world::{Scene, World};

use super::Passed;
use crate::common::{CommonArgs, Failure};

/// Cones, the referee's corridor, and the start.
#[derive(Debug, Clone)]
pub(crate) struct Course {
    pub(crate) cones: Vec<Cone>,
    pub(crate) corridor: Corridor,
    pub(crate) start: Pose,
    /// Whether it is much wider than a Formula Student track, like TUM's circuits; the racer is informed.
    pub(crate) wide: bool,
    /// Whether there is room for two cars abreast: about twice the width of a Formula Student track; the
    /// racer is informed.
    pub(crate) abreast: bool,
    /// The acceleration or skidpad event, if it is not a course of laps.
    pub(crate) event: Option<EventCourse>,
}

/// Margin around the driven path (m).
const MARGIN: f64 = 5.0;
/// Margin beyond the ground around the cones within which a picture shows a car that left it (m).
const BEYOND: f64 = 40.0;

/// Disturbances of the cones before the race.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Spoils {
    /// Fraction of additional cones beside the track that belong to neither edge.
    pub(crate) false_cones: f64,
    /// Fraction of missing cones.
    pub(crate) missing: f64,
    /// Length over which one side has no cones (m).
    pub(crate) gap: f64,
}

/// Distance from the rear axle at the start to the timing line, if a file has none ahead of the car (m).
const RUN_UP: f64 = 6.0;

/// Minimum and maximum width, and minimum radius of the centre line, of a track for two cars (m): in a bend,
/// a car needs 1.8 m, and between them and the cones there is 0.5 m or more.
const TWO_ABREAST: [f64; 2] = [6.5, 7.5];
const LEAST_RADIUS: f64 = 7.0;

/// The middle of the timing line: ahead of the car at the start, so that the first lap is timed as well.
fn line_of(track: &ConeTrack, start: Pose) -> Point {
    let gates = track.gates.iter().map(|[a, b]| a + (b - a) * 0.5);
    let mut ahead = gates.filter(|middle| {
        let local = start.to_local(*middle);
        (2.0..12.0).contains(&local.x) && local.y.abs() < 3.0
    });
    ahead.next_back().unwrap_or_else(|| start.to_world(Point::new(RUN_UP, 0.0)))
}

impl Course {
    /// A generated track.
    pub(crate) fn generated(seed: u64) -> Result<Self, Failure> {
        let GeneratedTrack { track, corridor } =
            generate(seed, &TrackOptions::drawn(seed)).map_err(Failure::input)?;
        let start = track.start_pose().ok_or_else(|| Failure::input("the track has no start"))?;
        Ok(Self { cones: track.cones, corridor, start, wide: false, abreast: false, event: None })
    }

    /// A generated track on which two cars have room abreast.
    pub(crate) fn for_two(seed: u64) -> Result<Self, Failure> {
        let options = TrackOptions { width: TWO_ABREAST, radius: LEAST_RADIUS, ..TrackOptions::drawn(seed) };
        let GeneratedTrack { track, corridor } = generate(seed, &options).map_err(Failure::input)?;
        let start = track.start_pose().ok_or_else(|| Failure::input("the track has no start"))?;
        Ok(Self { cones: track.cones, corridor, start, wide: false, abreast: true, event: None })
    }

    /// The same course, for two cars, if its mean width is more than that of usual tracks.
    pub(crate) fn shared(self) -> Self {
        let widths = self.corridor.stations().iter().map(|station| station.left + station.right);
        let mean = widths.sum::<f64>() / self.corridor.stations().len() as f64;
        let abreast = !self.wide && mean > 2.0 * LaneParameters::default().half_width[1];
        Self { abreast, ..self }
    }

    /// The track of a file, for laps.
    pub(crate) fn from_file(common: &CommonArgs, path: &Path) -> Result<Self, Failure> {
        let file = Self::read(common, path)?;
        if let TrackFile::Cones(track) = &file
            && EventCourse::of(track, &Self::outline()).is_some()
        {
            return Err(Failure::input(format!(
                "--track {}: found a track of an acceleration or a skidpad, which `cone_race` drives; expected one of laps",
                path.display()
            )));
        }
        Self::of_laps(file, path)
    }

    /// The track of a file, for the event given by its cones.
    pub(crate) fn for_its_event(file: TrackFile, path: &Path) -> Result<Self, Failure> {
        if let TrackFile::Cones(track) = &file
            && let Some(start) = track.start_pose()
            && let Some(event) = EventCourse::of(track, &Self::outline())
        {
            let (cones, corridor) = (track.cones.clone(), event.corridor().clone());
            return Ok(Self { cones, corridor, start, wide: false, abreast: false, event: Some(event) });
        }
        Self::of_laps(file, path)
    }

    /// Content of a track file.
    pub(crate) fn read(common: &CommonArgs, path: &Path) -> Result<TrackFile, Failure> {
        let bytes = common.read("track", path).map_err(Failure::input)?;
        let text = String::from_utf8_lossy(&bytes);
        parse_track(&text, &path.display().to_string()).map_err(Failure::input)
    }

    fn of_laps(file: TrackFile, path: &Path) -> Result<Self, Failure> {
        match file {
            TrackFile::Cones(track) => Self::between(&track, path),
            TrackFile::Corridor(corridor) => {
                let refused = |error| Failure::input(format!("--track {}: {error}", path.display()));
                let GeneratedTrack { track, corridor } = lined(&corridor, 4.8).map_err(refused)?;
                let start = track.start_pose().ok_or_else(|| Failure::input("the track has no start"))?;
                Ok(Self { cones: track.cones, corridor, start, wide: true, abreast: false, event: None })
            }
            TrackFile::Line(_) => Err(Failure::input(format!(
                "--track {}: found a line without widths; expected a track",
                path.display()
            ))),
            TrackFile::Log(_) => Err(Failure::input(format!(
                "--track {}: found a log of a drive; expected a track",
                path.display()
            ))),
        }
    }

    fn between(track: &ConeTrack, path: &Path) -> Result<Self, Failure> {
        let strip = match track.event() {
            Event::Acceleration => ", or a start up to 8 m before the strip of an acceleration",
            _ => "",
        };
        let refused = |found: String| {
            Failure::input(format!(
                "--track {}: found {found}; expected blue and yellow cones around a closed track{strip}",
                path.display()
            ))
        };
        let start = track.start_pose().ok_or_else(|| {
            let [blue, yellow] = [ConeColour::Blue, ConeColour::Yellow].map(|paint| track.of(paint).count());
            refused(format!("no start, {blue} blue and {yellow} yellow cones"))
        })?;
        let line =
            CentreLine::round_track(&track.cones, start).map_err(|error| refused(error.to_string()))?;
        let corridor = line.corridor.beginning_near(line_of(track, start));
        Ok(Self { cones: track.cones.clone(), corridor, start, wide: false, abreast: false, event: None })
    }

    /// Removes and adds cones.
    pub(crate) fn spoil(&mut self, spoils: Spoils, seed: u64) {
        let random = Stream::new(seed);
        let (mut missing, mut added) = (random.child("missing", 0), random.child("false", 0));
        let before = self.cones.len();
        let stations = self.corridor.stations();
        let n = stations.len();
        if spoils.gap > 0.0 {
            let mut gap = random.child("gap", 0);
            let left = gap.chance(0.5);
            let length = (spoils.gap / self.corridor.length() * n as f64).ceil() as usize;
            let from = n / 8 + gap.below((n - n / 4).saturating_sub(length).max(1));
            let edge = self.corridor.edge(left);
            self.cones
                .retain(|cone| (from..from + length).all(|k| (edge[k % n] - cone.position).norm() > 0.9));
        }
        self.cones.retain(|_| !missing.chance(spoils.missing));
        for _ in 0..(spoils.false_cones * before as f64).round() as usize {
            let station = stations[added.below(n)];
            let beyond = added.between(0.8, 3.0);
            let left = added.chance(0.5);
            let place = station.aside(if left { station.left + beyond } else { -station.right - beyond });
            // Not on another part of the track.
            let clear = stations.iter().all(|s| (s.position - place).norm() > s.left.max(s.right) + 0.5);
            if clear {
                self.cones.push(Cone::unknown(place));
            }
        }
    }

    /// Reason why no car can drive around it: a gate between a blue and a yellow cone is narrower than the
    /// car.
    pub(crate) fn impassable(&self) -> Option<String> {
        let width = 2.0 * Self::outline().half_width;
        let of = |paint: ConeColour| self.cones.iter().filter(move |cone| cone.colour == paint);
        let gates = of(ConeColour::Blue).flat_map(|left| {
            let free = |right: &Cone| {
                (left.position - right.position).norm() - left.colour.radius() - right.colour.radius()
            };
            of(ConeColour::Yellow).map(free)
        });
        let narrowest = gates.fold(f64::INFINITY, f64::min);
        (narrowest < width).then(|| {
            format!(
                "a gate leaves {narrowest:.2} m between the feet of its cones; expected at least the car's width of {width:.2} m"
            )
        })
    }

    /// The pose in the middle, a distance behind the line, or before it if that is negative (m).
    pub(crate) fn ahead(&self, metres: f64) -> Pose {
        let stations = self.corridor.stations();
        let spacing = self.corridor.length() / stations.len() as f64;
        let way = metres.rem_euclid(self.corridor.length());
        let station = stations[(way / spacing) as usize % stations.len()];
        let heading = math::atan2(-station.normal.x, station.normal.y);
        Pose::new(station.position.x, station.position.y, heading)
    }

    /// The ground around the cones.
    pub(crate) fn ground(&self) -> World {
        World { objects: Vec::new(), ..self.scene(&[]).world }
    }

    /// The ground around cones and driven path, for pictures, up to a limit.
    pub(crate) fn frame(&self, trail: &[Passed]) -> World {
        let mut world = self.ground();
        let most = world.floor.inflated(BEYOND);
        let driven = trail.iter().map(|passed| passed.pose.position()).filter(|place| most.contains(*place));
        if let Some(around) = Aabb::around(driven) {
            world.floor = world.floor.union(&around.inflated(MARGIN));
        }
        world
    }

    /// The ground with the cones and cars.
    pub(crate) fn scene(&self, cars: &[Pose]) -> Scene {
        ConeTrack { cones: self.cones.clone(), ..ConeTrack::default() }.scene(cars)
    }

    /// Parameters of the racer.
    pub(crate) fn parameters(&self, laps: usize) -> RacerParameters {
        let mut parameters = RacerParameters { laps, ..RacerParameters::default() };
        if self.wide {
            parameters.centre_line.width = [6.0, 24.0];
            parameters.map.farthest = 24.0;
            parameters.first_lap.top_speed = 10.0;
            parameters.lane = LaneParameters {
                ahead: 24.0,
                curvature: 0.12,
                half_width: [3.0, 11.0],
                usual: 5.5,
                loose: 2.0,
                // At a self-crossing of a circuit, no edge turns the corner.
                sharpest: 1.0,
                ..LaneParameters::default()
            };
        }
        if self.abreast {
            parameters.centre_line.width = [4.5, 9.0];
            parameters.lane = LaneParameters { half_width: [2.4, 4.4], usual: 3.5, ..parameters.lane };
        }
        parameters
    }

    /// Camera resolution at which the cones of both edges are visible.
    pub(crate) fn resolution(&self) -> Resolution {
        if self.wide { Resolution::Cam1Mp } else { Resolution::Vga }
    }

    /// Outline of the car.
    pub(crate) fn outline() -> CarOutline {
        RacerParameters::default().outline
    }

    /// The referee's wheel positions in the car's frame.
    pub(crate) fn wheels() -> [Point; 4] {
        [(0.0, 0.6), (0.0, -0.6), (1.55, 0.6), (1.55, -0.6)].map(|(x, y)| Point::new(x, y))
    }
}
