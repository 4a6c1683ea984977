use roverlab::geometry::{Aabb, Point, units};
use roverlab::world::{RobotSpec, Scene};

use super::Shore;
use crate::common::Failure;

/// What of a world's water is to be surveyed or searched.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Site {
    /// Between the sides.
    pub(crate) area: Aabb,
    /// Whether these are straight, so that they tell the place.
    pub(crate) by_walls: bool,
    /// Whether nothing else is in the way of lanes between them.
    is_open: bool,
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
            return Self { area: world.site(), by_walls: false, is_open: true };
        };
        let inset = |point: Point| {
            let (low, high) = (point - area.min, area.max - point);
            low.x.min(low.y).min(high.x).min(high.y)
        };
        let by_walls = shore.points().all(|point| inset(point) < STRAIGHT);
        let is_open = !shore.crosses(&area.inflated(-NEAREST));
        Self { area, by_walls, is_open }
    }

    /// The same; fails where lanes would lead over walls or ground.
    pub(crate) fn open(scene: &Scene, depth: f64) -> Result<Self, Failure> {
        let site = Self::of(scene, depth);
        if site.is_open {
            return Ok(site);
        }
        let (found, size) =
            (units::to_mm(depth).round(), site.area.size().map(|side| units::to_mm(side).round()));
        Err(Failure::input(format!(
            "found walls or ground amid the water of {} x {} mm around the craft, {found} mm deep; expected \
             water with nothing in it but at its sides",
            size.x, size.y
        )))
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
