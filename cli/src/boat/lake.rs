use roverlab::geometry::{Aabb, Point, Pose, Vector, direction, math};
use roverlab::random::Stream;
use roverlab::world::{HeightField, RobotSpec, Scene, Terrain, Water, Waves, World};

use crate::common::Failure;
use crate::water::{Shore, ground};

/// A lake with a raft, and a course on it.
#[derive(Debug, Clone)]
pub(super) struct Lake {
    pub(super) scene: Scene,
    pub(super) course: Vec<Point>,
}

/// Metres of the lake, of its water, and to the shores that a course keeps.
const SIZE: [f64; 2] = [40.0, 30.0];
const LEVEL: f64 = 3.0;
const CLEAR: f64 = 2.0;
/// Metres of a raft's hull in the water, with what it pitches.
const DRAUGHT: f64 = 0.25;
/// Islands, and waypoints of a course.
const ISLANDS: [usize; 2] = [1, 4];
const WAYPOINTS: [usize; 2] = [3, 6];
/// The least and the longest leg (m).
const LEG: [f64; 2] = [4.0, 18.0];
/// The most of current, wind (m/s) and waves (m).
const CURRENT: f64 = 0.2;
const WIND: f64 = 4.0;
const WAVES: f64 = 0.15;
/// Range of the Doppler log (m).
const RANGE: f64 = 30.0;

/// The raft, with a Doppler log.
pub(super) fn raft() -> RobotSpec {
    RobotSpec { dvl: Some(RANGE), ..RobotSpec::solar_raft() }
}

/// The lake of a seed.
pub(super) fn lake(seed: u64) -> Result<Lake, Failure> {
    let mut stream = Stream::new(seed).child("lake", 0);
    let world = World { water: weather(&mut stream), ..islands(&mut stream)? };
    let shore = Shore::of(&world, LEVEL - DRAUGHT);
    let [width, height] = SIZE;
    let count = WAYPOINTS[0] + stream.below(WAYPOINTS[1] - WAYPOINTS[0] + 1);
    let mut points: Vec<Point> = Vec::new();
    while points.len() <= count {
        let place = Point::new(stream.between(0.0, width), stream.between(0.0, height));
        let is_good = match points.last() {
            Some(&last) => {
                (LEG[0]..=LEG[1]).contains(&(place - last).norm()) && is_clear(&shore, last, place)
            }
            None => is_wet(&world, place) && is_clear(&shore, place, place),
        };
        if is_good {
            points.push(place);
        }
    }
    let start = points.remove(0);
    let heading = stream.between(-3.1, 3.1);
    let start = Pose::new(start.x, start.y, heading);
    Ok(Lake { scene: Scene::with_robot(world, raft(), start), course: points })
}

fn weather(stream: &mut Stream) -> Water {
    let mut blown =
        |most: f64| -> Vector { direction(stream.between(-3.1, 3.1)) * stream.between(0.0, most) };
    let (current, wind) = (blown(CURRENT), blown(WIND));
    let waves = Waves {
        height: stream.between(0.02, WAVES),
        period: stream.between(1.6, 3.0),
        direction: stream.between(-3.1, 3.1),
        irregular: true,
    };
    Water { current: vec![(0.0, current)], wind, waves: Some(waves), ..Water::default() }
}

/// A basin whose islands are bells.
fn islands(stream: &mut Stream) -> Result<World, Failure> {
    let [width, height] = SIZE;
    let count = ISLANDS[0] + stream.below(ISLANDS[1] - ISLANDS[0] + 1);
    let islands: Vec<(Point, f64, f64)> = (0..count)
        .map(|_| {
            let middle = Point::new(stream.between(6.0, width - 6.0), stream.between(6.0, height - 6.0));
            (middle, stream.between(3.3, 4.5), stream.between(0.8, 2.0))
        })
        .collect();
    let floor = |at: Point| {
        let bell = |&(middle, top, wide): &(Point, f64, f64)| {
            top * math::exp(-0.5 * (at - middle).norm_squared() / (wide * wide))
        };
        let inside = at.x.min(width - at.x).min(at.y).min(height - at.y);
        let bank = (LEVEL + 0.5) * (1.0 - 0.5 * inside).clamp(0.0, 1.0);
        islands.iter().map(bell).fold(bank, f64::max)
    };
    let area = Aabb::new(Point::origin(), Point::new(width, height));
    let surface = HeightField::from_fn(161, 121, area, floor).map_err(Failure::run)?;
    Ok(World {
        terrain: Some(Terrain::new("lake", surface)),
        water_level: Some(LEVEL),
        ..World::empty(width, height)
    })
}

fn is_wet(world: &World, place: Point) -> bool {
    ground(world).is_none_or(|ground| ground.height(place).is_some_and(|floor| floor < LEVEL - DRAUGHT))
}

/// Whether the way from a place to another one keeps from the shores.
fn is_clear(shore: &Shore, from: Point, to: Point) -> bool {
    let steps = ((to - from).norm() / 0.5).ceil() as u32 + 1;
    (0..=steps).all(|step| {
        let place = from + (to - from) * (f64::from(step) / f64::from(steps));
        let inside = place.x.min(SIZE[0] - place.x).min(place.y).min(SIZE[1] - place.y);
        inside > CLEAR && shore.distance(place).is_none_or(|distance| distance > CLEAR)
    })
}
