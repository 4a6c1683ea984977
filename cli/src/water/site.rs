use roverlab::geometry::{Aabb, Point};
use roverlab::world::{RobotSpec, Scene};

use super::Shore;

/// What of a world's water is to be surveyed or searched.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Site {
    /// Between the sides.
    pub(crate) area: Aabb,
    /// Whether these are straight, so that they tell the place.
    pub(crate) by_walls: bool,
}

/// Metres that sides may be off straight ones.
const STRAIGHT: f64 = 0.05;
impl Site {
    /// The water around a scene's first robot at a depth.
    pub(crate) fn of(scene: &Scene, depth: f64) -> Self {
        let world = &scene.world;
        let level = world.water_level.unwrap_or_default();
        let shore = Shore::of(world, level - depth).around(scene.robots[0].pose.position());
        let Some(area) = shore.bounds() else {
            return Self { area: world.site(), by_walls: false };
        };
        let inset = |point: Point| {
            let (low, high) = (point - area.min, area.max - point);
            low.x.min(low.y).min(high.x).min(high.y)
        };
        let by_walls = shore.points().all(|point| inset(point) < STRAIGHT);
        Self { area, by_walls }
    }
}

/// Seconds for a metre of lanes, and besides.
const PACE: f64 = 5.0;
const BESIDES: f64 = 300.0;

/// Seconds for the lanes of a site.
pub(crate) fn limit(site: &Site, spacing: f64) -> f64 {
    let size = site.area.size();
    PACE * (size.x * size.y / spacing + size.x + size.y) + BESIDES
}

/// Metres off the sides at which Mako, which is half as wide, keeps clear of them on a lane.
pub(crate) const NEAREST: f64 = 0.75;
/// Range of the Doppler log (m).
const RANGE: f64 = 30.0;

/// Mako with a Doppler log.
pub(crate) fn surveyor() -> RobotSpec {
    RobotSpec { dvl: Some(RANGE), ..RobotSpec::mako() }
}
