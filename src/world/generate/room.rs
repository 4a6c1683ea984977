use crate::ParameterError;
use crate::parameter::require;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::contour::Contour;
use super::decor::decorated;
use crate::geometry::{Aabb, Point, Pose, direction, units};
use crate::random::Stream;
use crate::world::World;

/// Options of [`super::room`].
#[derive(Debug, Clone, PartialEq)]
pub struct RoomOptions {
    /// Smallest and largest distance from a room's centre to its corners (m).
    pub reach: (f64, f64),
    /// Smallest and largest interior angle of a corner (rad).
    pub corners: (f64, f64),
    /// Smallest radius of a curved wall (m).
    pub least_radius: f64,
    /// Distance from the wall that a robot must be able to keep everywhere (m).
    pub distance: f64,
}

impl Default for RoomOptions {
    /// Rooms of about 5 m, corners of 60 to 300 degrees and curves with radii from 0.5 m, for a distance of
    /// 0.2 m.
    fn default() -> Self {
        Self {
            reach: (1.1, 2.8),
            corners: (units::from_deg(60.0), units::from_deg(300.0)),
            least_radius: 0.5,
            distance: 0.2,
        }
    }
}

impl RoomOptions {
    /// Fails with the name of an option out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        let distance = self.distance;
        require("distance", distance, (0.05..=1.0).contains(&distance), "0.05 to 1 m")?;
        let (least, most) = self.reach;
        require("least reach", least, least >= 4.0 * distance, "at least four distances")?;
        require("greatest reach", most, most >= least && most <= 100.0, "the least reach to 100 m")?;
        let (sharpest, widest) = self.corners;
        require("least of the corners", sharpest, (0.5..FRAC_PI_2).contains(&sharpest), "0.5 to 1.57 rad")?;
        require(
            "greatest of the corners",
            widest,
            (3.0 * FRAC_PI_2..5.8).contains(&widest),
            "4.71 to 5.8 rad",
        )?;
        let radius = self.least_radius;
        require("least radius", radius, radius >= 1.5 * distance && radius <= 10.0, "1.5 distances to 10 m")
    }
}

/// A special feature along a room's wall.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum RoomFeature {
    /// A rounded corner.
    Rounding,
    /// An outward arc: the wall recedes.
    Bay,
    /// An arc into the room.
    Bulge,
    /// An open door with a chamber behind it.
    Door,
    /// A closed door, slightly recessed.
    ClosedDoor,
    /// A wedge into the room, with a corner of far more than three right angles.
    Wedge,
    /// A pointed niche: a sharp corner between two corners of more than a half turn.
    Nook,
}

/// A room with a single closed wall.
#[derive(Debug, Clone, PartialEq)]
pub struct Room {
    /// The walls; its start pose is the room's.
    pub world: World,
    /// A pose in the room with a random heading.
    pub start: Pose,
    /// The corners with their interior angles (rad).
    pub corners: Vec<(Point, f64)>,
    /// Other features.
    pub features: Vec<RoomFeature>,
}

/// Draws a room whose wall can be followed at a distance all the way round, with corners, curves, and doors;
/// open doors have a chamber behind them.
///
/// ```
/// use roverlab::random::Stream;
/// use roverlab::world::generate::{RoomOptions, room};
/// let room = room(&mut Stream::new(1), &RoomOptions::default())?;
/// assert!(room.corners.len() >= 3 && room.world.start == Some(room.start));
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
///
/// # Errors
///
/// If the options do not pass [`RoomOptions::validate`].
pub fn room(stream: &mut Stream, options: &RoomOptions) -> Result<Room, ParameterError> {
    /// Number of attempts to draw a room.
    const TRIES: usize = 5000;
    options.validate()?;
    for _ in 0..TRIES {
        if let Some(room) = try_room(stream, options) {
            return Ok(room);
        }
    }
    let side = 2.0 * options.reach.0;
    let square = [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)].map(|(x, y)| Point::new(x, y));
    let contour = Contour::of_corners(&square);
    let start = Pose::new(0.5 * side, 0.5 * side, 0.0);
    Ok(finish(&contour, start, Vec::new()))
}

fn try_room(stream: &mut Stream, options: &RoomOptions) -> Option<Room> {
    let corners = base(stream, options);
    let plain = Contour::of_corners(&corners);
    if !plain.angles_within(options.corners) {
        return None;
    }
    let (contour, features) = decorated(stream, options, &corners);
    if !contour.angles_within(options.corners) || !contour.can_be_followed(options.distance) {
        return None;
    }
    let bounds = contour.bounds();
    let start = (0..50).find_map(|_| {
        let point = Point::new(
            stream.between(bounds.min.x, bounds.max.x),
            stream.between(bounds.min.y, bounds.max.y),
        );
        (contour.holds(point) && contour.distance_to(point) > 1.5 * options.distance).then_some(point)
    })?;
    let start = Pose::new(start.x, start.y, stream.between(-PI, PI));
    Some(finish(&contour, start, features))
}

/// Corners of a basic room, counter-clockwise.
fn base(stream: &mut Stream, options: &RoomOptions) -> Vec<Point> {
    let (least, most) = options.reach;
    if stream.chance(0.25) {
        // A rectangle with a notch.
        let (w, h) = (stream.between(2.0 * least, 2.0 * most), stream.between(2.0 * least, 2.0 * most));
        let (x, y) = (stream.between(0.3, 0.65) * w, stream.between(0.3, 0.65) * h);
        return [(0.0, 0.0), (w, 0.0), (w, y), (x, y), (x, h), (0.0, h)]
            .map(|(x, y)| Point::new(x, y))
            .into();
    }
    let n = 4 + stream.below(6);
    let turn = stream.between(0.0, TAU);
    (0..n)
        .map(|i| {
            let angle = turn + TAU * (i as f64 + stream.between(-0.3, 0.3)) / n as f64;
            Point::origin() + direction(angle) * stream.between(least, most)
        })
        .collect()
}

fn finish(contour: &Contour, start: Pose, features: Vec<RoomFeature>) -> Room {
    /// Width of the floor around a room (m).
    const MARGIN: f64 = 0.2;
    let bounds = contour.bounds().inflated(MARGIN);
    let shift = Point::origin() - bounds.min;
    let size = bounds.size();
    let start = Pose::new(start.x + shift.x, start.y + shift.y, start.heading);
    let world = World {
        floor: Aabb::new(Point::origin(), Point::origin() + size),
        walls: contour.walls(shift),
        start: Some(start),
        ..World::empty(size.x, size.y)
    };
    let corners = contour.corners().into_iter().map(|(point, angle)| (point + shift, angle)).collect();
    Room { world, start, corners, features }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nav::Reachability;

    #[test]
    fn rooms_have_all_features_and_corners_of_all_angles() {
        let options = RoomOptions::default();
        let rooms: Vec<Room> = (0..400).map(|seed| room(&mut Stream::new(seed), &options).unwrap()).collect();
        let mut features: Vec<RoomFeature> = rooms.iter().flat_map(|room| room.features.clone()).collect();
        features.sort_unstable();
        features.dedup();
        assert_eq!(features.len(), 7, "{features:?}");
        let with = |feature| rooms.iter().filter(|room: &&Room| room.features.contains(&feature)).count();
        for feature in [RoomFeature::Door, RoomFeature::Wedge, RoomFeature::Nook] {
            assert!(with(feature) >= 20, "{feature:?} in {} of 400 rooms", with(feature));
        }
        let angles: Vec<f64> = rooms.iter().flat_map(|room| &room.corners).map(|&(_, angle)| angle).collect();
        let (least, most) = options.corners;
        assert!(angles.iter().all(|angle| (least..=most).contains(angle)));
        for range in [60.0..90.0, 100.0..170.0, 190.0..260.0, 260.0..280.0, 285.0..300.0] {
            assert!(angles.iter().any(|&angle| range.contains(&units::to_deg(angle))), "{range:?}");
        }
    }

    #[test]
    fn starts_are_free_and_equal_seeds_give_equal_rooms() {
        for seed in 0..20 {
            let room = room(&mut Stream::new(seed), &RoomOptions::default()).unwrap();
            let free = Reachability::new(&room.world, 0.1, 0.02).unwrap();
            assert!(free.is_free(room.start.position()), "{seed}");
            // The room has no exit.
            assert!(!free.connected(room.start.position(), Point::new(-0.1, -0.1)), "{seed}");
            assert_eq!(super::room(&mut Stream::new(seed), &RoomOptions::default()).unwrap(), room);
        }
    }

    #[test]
    fn nonsense_is_refused() {
        let good = RoomOptions::default();
        for bad in [
            RoomOptions { reach: (0.1, 2.0), ..good.clone() },
            RoomOptions { reach: (2.0, 1.0), ..good.clone() },
            RoomOptions { corners: (0.1, 5.0), ..good.clone() },
            RoomOptions { least_radius: f64::NAN, ..good.clone() },
            RoomOptions { distance: 0.0, ..good.clone() },
        ] {
            let error = room(&mut Stream::new(1), &bad).unwrap_err();
            assert!(error.to_string().contains("expected"), "{error}");
        }
    }
}
