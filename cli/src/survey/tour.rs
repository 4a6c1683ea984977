use roverlab::drive::marine::{DepthMap, Survey, SurveyOutcome, SurveyParameters};
use roverlab::geometry::{Aabb, Point, Point3, Vector};
use roverlab::io::{Psd, TruthInSpace, control};
use roverlab::world::{Scene, World};

use crate::common::{Failure, portable};
use crate::driving::{Conditions, Run};
use crate::water::{NEAREST, Site, ground};

/// A survey, its map, and how good it is.
#[derive(Debug, Clone)]
pub(super) struct Tour {
    pub(super) run: Run<SurveyOutcome>,
    pub(super) map: DepthMap,
    /// Width of its cells (m).
    pub(super) cell: f64,
    pub(super) quality: Quality,
}

/// What a map is like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Quality {
    /// Shares of cells: with a depth, and of these within two standard deviations.
    pub(super) coverage: f64,
    pub(super) inside: f64,
    /// Metres, of 95 %.
    pub(super) depth: Option<f64>,
    pub(super) position: Option<f64>,
    /// Length of the way over area by spacing.
    pub(super) way: f64,
    pub(super) by_walls: bool,
    /// Root mean square error of the altitude (m), where one is held.
    pub(super) altitude: Option<f64>,
}

portable!(struct Quality { coverage, inside, depth, position, way, by_walls, altitude });

/// The least share of cells with a depth of a floor that is covered.
pub(super) const COVERED: f64 = 0.99;
/// The sensor that points down.
const DOWN: Psd = Psd(6);
/// Metres from the altitude at which it counts as reached.
const REACHED: f64 = 0.01;
/// Metres off the sides at which cells begin.
pub(super) const OFF: f64 = 0.5;
/// The least width of a cell (m): lanes along the sides are in the middle of the cells there.
const NARROWEST: f64 = 2.0 * (NEAREST - OFF);
/// Points of a cell along each side, of which its true depth is the mean.
const POINTS: u32 = 6;

/// Surveys a scene's water.
pub(super) fn tour(
    scene: &Scene,
    parameters: SurveyParameters,
    conditions: &Conditions,
    watch: impl FnMut(f64),
) -> Result<Tour, Failure> {
    let robot = &scene.robots[0];
    let site = Site::of(scene, parameters.depth);
    let mut survey =
        Survey::new(&robot.spec, robot.pose, site.area, site.by_walls, parameters).map_err(Failure::input)?;
    let (cells, cell) = whole_cells(&site.area.inflated(-OFF), parameters.spacing.max(NARROWEST));
    let mut map = DepthMap::new(cells, cell).map_err(Failure::input)?;
    let mut beliefs = Vec::new();
    let run = conditions.run(scene, watch, |robot, step| {
        control::run(robot, &mut survey, conditions.time_limit, |_, survey, _| {
            step();
            beliefs.push(survey.belief().0);
            survey.sounding().into_iter().for_each(|sounding| map.add(sounding));
        })
    })?;
    let errors = run.trail.iter().skip(1).zip(&beliefs);
    let errors = errors.map(|((_, pose), belief)| (pose.position() - belief.position()).norm()).collect();
    let size = site.area.size();
    let quality = Quality {
        position: percentile(errors),
        way: run.truth.path_length * parameters.spacing / (size.x * size.y),
        by_walls: site.by_walls,
        altitude: parameters.altitude.and_then(|wanted| altitude_error(scene, wanted, &run)),
        ..judged(&scene.world, &map, cell)
    };
    Ok(Tour { run, map, cell, quality })
}

/// The true mean depth of a cell; `None` where it is not all water.
pub(super) fn true_depth(world: &World, centre: Point, cell: f64) -> Option<f64> {
    let level = world.water_level?;
    let mut sum = 0.0;
    for point in 0..POINTS * POINTS {
        let share = |index: u32| (f64::from(index) + 0.5) / f64::from(POINTS) - 0.5;
        let at = centre + Vector::new(share(point % POINTS), share(point / POINTS)) * cell;
        let floor = ground(world).map_or(Some(0.0), |ground| ground.height(at))?;
        sum += level - floor;
        if floor >= level {
            return None;
        }
    }
    Some(sum / f64::from(POINTS * POINTS))
}

/// The size of cells, at most so wide, that fill the narrower side of an area; and the part of it that whole
/// ones cover, in the middle of the longer side.
fn whole_cells(area: &Aabb, widest: f64) -> (Aabb, f64) {
    let size = area.size();
    let narrow = size.min();
    let cell = narrow / (narrow / widest).ceil().max(1.0);
    // A hair less, so that rounding begins no further row.
    let half = (size / cell).map(|cells| 0.5 * cell * (cells + 1e-9).floor() - 1e-9);
    let middle = area.min + 0.5 * size;
    (Aabb::new(middle - half, middle + half), cell)
}

/// What is true of the map.
fn judged(world: &World, map: &DepthMap, cell: f64) -> Quality {
    let (mut cells, mut inside, mut errors) = (0_u32, 0_u32, Vec::new());
    for (column, row) in (0..map.rows()).flat_map(|row| (0..map.columns()).map(move |column| (column, row))) {
        let centre = map.centre(column, row);
        let Some(depth) = true_depth(world, centre, cell) else { continue };
        cells += 1;
        let Some(measured) = map.cell(column, row) else { continue };
        let error = (measured.depth - depth).abs();
        errors.push(error);
        inside += u32::from(error <= 2.0 * measured.sigma);
    }
    let known = errors.len() as f64;
    Quality {
        coverage: known / f64::from(cells.max(1)),
        inside: f64::from(inside) / known.max(1.0),
        depth: percentile(errors),
        position: None,
        way: 0.0,
        by_walls: false,
        altitude: None,
    }
}

/// The root mean square error of the altitude of the sensor that points down, from when it first was as
/// wanted; `None` if it never was.
fn altitude_error<T>(scene: &Scene, wanted: f64, run: &Run<T>) -> Option<f64> {
    let sensor = scene.robots[0].spec.psds.iter().find(|psd| psd.id == DOWN.0)?.mount;
    let error = |space: &TruthInSpace| {
        let place = space.pose.to_world(Point3::new(sensor.x, sensor.y, sensor.z));
        let floor = ground(&scene.world).map_or(Some(0.0), |ground| ground.height(place.xy()))?;
        Some(place.z - floor - wanted)
    };
    let errors = run.in_space.iter().filter_map(error).skip_while(|error| error.abs() > REACHED);
    let (sum, count) = errors.fold((0.0, 0_u32), |(sum, count), error| (sum + error * error, count + 1));
    (count > 0).then(|| (sum / f64::from(count)).sqrt())
}

/// What 95 % of some numbers are at most.
fn percentile(mut numbers: Vec<f64>) -> Option<f64> {
    numbers.sort_by(f64::total_cmp);
    numbers.get((0.95 * numbers.len() as f64) as usize).copied()
}
