use roverlab::drive::marine::{PoolSearch, PoolSearchOutcome, PoolSearchParameters, SurveyParameters};
use roverlab::geometry::Point;
use roverlab::io::control;
use roverlab::vision::{HueLimits, HueScale, hue};
use roverlab::world::{Colour, Scene};

use crate::common::Failure;
use crate::driving::{Conditions, Run};
use crate::water::{NEAREST, Site};

/// A search and what came of it.
#[derive(Debug, Clone)]
pub(super) struct Hunt {
    pub(super) run: Run<PoolSearchOutcome>,
    /// Where something was found.
    pub(super) place: Option<Point>,
    /// Metres from there to the nearest red thing.
    pub(super) error: Option<f64>,
    /// Whether there is anything red.
    pub(super) is_there: bool,
}

/// Metres from anything red at which a find is none.
const FALSE: f64 = 0.3;
/// Metres of the depth sensor below the surface.
pub(super) const DEPTH: f64 = 0.5;
/// Hues on RoBIOS's scale that are still red: crimson to vermilion, as the search takes them.
const RED: [u8; 2] = [32, 52];

impl Hunt {
    pub(super) fn is_false(&self) -> bool {
        self.place.is_some() && self.error.is_none_or(|error| error > FALSE)
    }
}

/// Searches a scene's pool.
pub(super) fn hunt(scene: &Scene, conditions: &Conditions, watch: impl FnMut(f64)) -> Result<Hunt, Failure> {
    let robot = &scene.robots[0];
    let site = Site::of(scene, DEPTH);
    let survey = SurveyParameters {
        depth: DEPTH,
        brim: NEAREST,
        density: scene.world.water.density,
        ..SurveyParameters::default()
    };
    let parameters = PoolSearchParameters { survey, ..PoolSearchParameters::default() };
    let mut search = PoolSearch::new(&robot.spec, robot.pose, site.area, site.by_walls, parameters)
        .map_err(Failure::input)?;
    let run = conditions.run(scene, watch, |robot, step| {
        control::run(robot, &mut search, conditions.time_limit, |_, _, _| step())
    })?;
    let place = search.place();
    let objects = scene.world.objects.iter().zip(&run.objects);
    let red: Vec<_> = objects.filter(|(object, _)| is_red(object.kind.colour)).collect();
    let nearest = |place: Point| red.iter().map(|(_, there)| (*there - place).norm()).reduce(f64::min);
    let (error, is_there) = (place.and_then(nearest), !red.is_empty());
    Ok(Hunt { run, place, error, is_there })
}

fn is_red(Colour { red, green, blue }: Colour) -> bool {
    let hue = hue([red, green, blue], HueScale::Robios, HueLimits::default());
    (RED[0]..=RED[1]).contains(&hue)
}
