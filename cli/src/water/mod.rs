//! Shared by the commands in water: the world with a craft in it, its shores, and how it looks from the side.

mod pool;
mod shore;
mod side;
mod site;

use std::sync::Arc;

use roverlab::geometry::{Point, Pose};
use roverlab::world::{DriveSpec, HeightField, RobotSpec, Scene, Water, World};

use crate::common::{CommonArgs, Failure, StandIn};

pub(crate) use pool::{BOOK, LEVEL, pool};
pub(crate) use shore::Shore;
pub(crate) use side::Side;
pub(crate) use site::{NEAREST, Site, limit, surveyor};

/// Cells along a side of the grid on which a start is looked for.
const CELLS: usize = 40;

/// The options of a run in water, flattened into a command's own.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct WaterArgs {
    /// Water instead of all of the world's: lines of a world file with commas between them, such as
    /// "current 100 0, waves 40 2 90, wind 3000 0, turbidity 0.5".
    #[arg(long, value_name = "LINES", value_parser = parse_water)]
    pub(crate) water: Option<Water>,
}

fn parse_water(text: &str) -> Result<Water, String> {
    text.replace(',', "\n").parse::<Water>().map_err(|error| error.to_string())
}

/// The scene of the options, or the command's own, with a craft in its water. A world without a start has one
/// where the water is widest.
pub(crate) fn afloat(
    (common, waters): (&CommonArgs, &WaterArgs),
    spec: &RobotSpec,
    own: impl FnOnce() -> Scene,
) -> Result<Scene, Failure> {
    let mut scene = common.scene_or(own)?;
    let name = common.world.as_ref().map_or(String::new(), |file| format!("{}: ", file.display()));
    let Some(level) = scene.world.water_level else {
        return Err(Failure::input(format!(
            "{name}found a world without water; expected a line `water_level MM`"
        )));
    };
    if let Some(water) = &waters.water {
        scene.world.water.clone_from(water);
    }
    if scene.robots.is_empty() && common.start.is_none() && scene.world.start.is_none() {
        scene.world.start = widest(&scene.world, level);
    }
    let is_craft = |spec: &RobotSpec| matches!(spec.drive, DriveSpec::Craft(_));
    let stand_in = StandIn { spec: Arc::new(spec.clone()), suits: is_craft };
    let scene = common.placed_in(scene, &stand_in)?;
    let robot = &scene.robots[0];
    if !is_craft(&robot.spec) {
        let found = &robot.spec.name;
        return Err(Failure::input(format!(
            "{name}found robot {found} with another drive; expected a craft"
        )));
    }
    let floor = ground(&scene.world).map_or(Some(0.0), |ground| ground.height(robot.pose.position()));
    if floor.is_none_or(|floor| floor >= level) {
        return Err(Failure::input(format!("{name}found a start on dry ground; expected one in the water")));
    }
    Ok(scene)
}

/// The hills of a world; without them its floor is level.
pub(crate) fn ground(world: &World) -> Option<&HeightField> {
    world.terrain.as_ref().and_then(|terrain| terrain.surface.as_deref())
}

/// The place of a world's water that is farthest from its shores half-way down, its walls of any height, and
/// the floor's edges, looking along the longer side.
fn widest(world: &World, level: f64) -> Option<Pose> {
    let shore = Shore::of(world, 0.5 * level);
    let (low, size) = (world.floor.min, world.floor.size());
    let heading = if size.x >= size.y { 0.0 } else { std::f64::consts::FRAC_PI_2 };
    let mut best: Option<(f64, Point)> = None;
    for cell in 0..CELLS * CELLS {
        let share = |index: usize| (index as f64 + 0.5) / CELLS as f64;
        let place = Point::new(low.x + size.x * share(cell % CELLS), low.y + size.y * share(cell / CELLS));
        let is_wet =
            ground(world).is_none_or(|ground| ground.height(place).is_some_and(|floor| floor < 0.5 * level));
        let walls = world.walls.iter().map(|wall| wall.line.distance_to(place) - 0.5 * wall.thickness);
        let (below, above) = (place - world.floor.min, world.floor.max - place);
        let edges = [below.x, below.y, above.x, above.y];
        let room = walls.chain(edges).chain(shore.distance(place)).fold(f64::INFINITY, f64::min);
        if is_wet && best.is_none_or(|(most, _)| room > most) {
            best = Some((room, place));
        }
    }
    best.map(|(_, place)| Pose::new(place.x, place.y, heading))
}
