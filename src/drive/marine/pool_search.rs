use std::ops::ControlFlow;

use image::RgbImage;

use super::colour_spotter::{ColourSpotter, Sight};
use super::{Survey, SurveyObservation, SurveyOutcome, SurveyParameters, Thrust};
use crate::geometry::{Aabb, Point, Point3, Pose, Pose3, Vector3, math};
use crate::io::control::{Behaviour, Decision, Senses, halts};
use crate::io::{
    Camera, DepthSensor, DistanceSensors, Error, Inertial, Odometry, Resolution, Result, Servos,
};
use crate::world::{CameraSpec, Colour, RobotSpec};

/// Parameters of [`PoolSearch`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoolSearchParameters {
    /// Colour of the object.
    pub colour: Colour,
    /// Parameters of the lanes.
    pub survey: SurveyParameters,
}

impl Default for PoolSearchParameters {
    /// A red object.
    fn default() -> Self {
        Self { colour: Colour::RED, survey: SurveyParameters::default() }
    }
}

/// Observation of a [`PoolSearch`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PoolSearchObservation {
    /// Depth, attitude, log and distances.
    pub survey: SurveyObservation,
    /// Camera image of the floor.
    pub image: RgbImage,
}

/// Outcome of a [`PoolSearch`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum PoolSearchOutcome {
    /// An object of the colour was found.
    Found,
    /// All lanes are done without a find.
    NotFound,
    /// The same, but most pictures of the floor were too dark for any colour.
    Blind,
    /// The time limit came first.
    TimedOut,
    /// The observer stopped the run.
    Stopped,
}

halts!(PoolSearchOutcome {
    Found: "it was found",
    NotFound: "all lanes are done without a find",
    Blind: "nothing could be seen",
});

/// Searches the floor of a pool for a colour, along the lanes of a [`Survey`] with the camera pointing down
/// (book, section 8.5).
///
/// The position of the find is the mean of its detections, in the pool's frame. It is returned once the craft
/// has passed it.
///
/// ```
/// use std::sync::Arc;
/// use roverlab::drive::marine::{PoolSearch, PoolSearchOutcome, PoolSearchParameters};
/// use roverlab::geometry::{Aabb, Point, Pose};
/// use roverlab::io::control::run;
/// use roverlab::io::sim::{SimOptions, Simulation};
/// use roverlab::world::{Colour, Object, ObjectKind, RobotSpec, Scene, Shape, World};
///
/// let mut pool = World { water_level: Some(2.0), ..World::walled(6.0, 5.0) };
/// let brick = Shape::Box { length: 0.25, width: 0.2, height: 0.1 };
/// let brick = ObjectKind { mass: 5.0, ..ObjectKind::new("brick", brick, Colour::RED) };
/// pool.objects.push(Object::new(Arc::new(brick), Pose::new(4.0, 1.7, 0.5)));
/// let mako = RobotSpec { dvl: Some(10.0), ..RobotSpec::mako() };
/// let (start, area) = (Pose::new(1.5, 1.5, 0.0), Aabb::new(Point::origin(), Point::new(6.0, 5.0)));
/// let simulation = Simulation::new(&Scene::with_robot(pool, mako.clone(), start), SimOptions::with_noise(1.0, 1))?;
/// let mut search = PoolSearch::new(&mako, start, area, true, PoolSearchParameters::default())?;
/// let outcome = run(&mut simulation.robot(0)?, &mut search, 400.0, |_, _, _| {})?;
/// assert_eq!(outcome, PoolSearchOutcome::Found);
/// assert!((search.place().expect("found") - Point::new(4.0, 1.7)).norm() < 0.15);
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct PoolSearch {
    survey: Survey,
    spotter: ColourSpotter,
    camera: CameraSpec,
    area: Aabb,
    /// Position of the servo at which the camera looks straight down.
    down: f64,
    /// Depth of the deepest floor so far, by the sensor that looks down (m).
    deepest: f64,
    /// Pictures of the floor, and those of them that were dark.
    pictures: u32,
    dark: u32,
    finds: Vec<Find>,
    found: Option<Point>,
}

/// A thing, by where it was seen.
#[derive(Debug, Clone, Copy)]
struct Find {
    sum: nalgebra::Vector2<f64>,
    times: u32,
}

/// Pictures in which a thing must be: less is a glint.
const LEAST: u32 = 5;
/// Metres around a thing's place within which it is the same one.
const SAME: f64 = 0.4;
/// Servo that tilts the camera.
const TILT: u8 = 2;
/// Largest tilt away from straight down that counts as straight down (rad).
const NEARLY: f64 = 0.02;

impl PoolSearch {
    /// Creates a search of an area, as for [`Survey::new`]. Fails for a robot without a camera that can point
    /// down.
    pub fn new(
        robot: &RobotSpec,
        start: Pose,
        area: Aabb,
        sides: bool,
        parameters: PoolSearchParameters,
    ) -> Result<Self> {
        let camera = robot.camera.ok_or_else(|| Error::unsupported("camera"))?;
        let missing = -std::f64::consts::FRAC_PI_2 - camera.tilt;
        if missing.abs() > camera.max_tilt + NEARLY || camera.fisheye {
            return Err(Error::unsupported("flat picture of what is below"));
        }
        let down = if camera.max_tilt > 0.0 { (missing / camera.max_tilt).clamp(-1.0, 1.0) } else { 0.0 };
        Ok(Self {
            survey: Survey::new(robot, start, area, sides, parameters.survey)?,
            spotter: ColourSpotter::new(parameters.colour),
            camera,
            area,
            down,
            deepest: 0.0,
            pictures: 0,
            dark: 0,
            finds: Vec::new(),
            found: None,
        })
    }

    /// Where the find is in the pool's frame, once there is one.
    pub fn place(&self) -> Option<Point> {
        self.found
    }

    /// The lanes, and the craft's belief of its own place.
    pub fn survey(&self) -> &Survey {
        &self.survey
    }

    /// Takes notice of a picture. Returns where something of the colour is.
    fn look(&mut self, seen: &PoolSearchObservation) -> Result<Option<Point>> {
        if !(self.survey.is_ready() && seen.survey.down.is_finite()) {
            return Ok(None);
        }
        self.deepest = self.deepest.max(seen.survey.dive.depth + seen.survey.down);
        let altitude = self.deepest - seen.survey.dive.depth;
        self.pictures += 1;
        let (column, row) = match self.spotter.find(&seen.image, altitude).map_err(Error::caused_by)? {
            Sight::Thing { column, row } => (column, row),
            Sight::Nothing => return Ok(None),
            Sight::Dark => {
                self.dark += 1;
                return Ok(None);
            }
        };
        let focal = 0.5 * f64::from(seen.image.width()) / math::tan(0.5 * self.camera.field_of_view);
        // The top of the picture is ahead.
        let own = Vector3::new(-row, -column, -focal);
        let (pose, attitude) = (self.survey.belief().0, seen.survey.dive.attitude);
        let craft = Pose3::from_angles(
            Point3::new(pose.x, pose.y, seen.survey.down),
            attitude.roll,
            attitude.pitch,
            pose.heading,
        );
        let eye = craft.to_world(Point3::new(self.camera.mount.x, self.camera.mount.y, self.camera.mount.z));
        let ray = craft.rotate(own);
        let place = (eye + ray * (eye.z / -ray.z)).xy();
        // A wall is nearer to the light than the floor, and so is redder; what it hides is outside.
        Ok((ray.z < 0.0 && self.area.contains(place)).then_some(place))
    }

    /// Adds a place to the thing that is there, or as another one.
    fn note(&mut self, place: Point) {
        let near = |find: &&mut Find| (find.place() - place).norm() < SAME;
        match self.finds.iter_mut().find(near) {
            Some(find) => (find.sum, find.times) = (find.sum + place.coords, find.times + 1),
            None => self.finds.push(Find { sum: place.coords, times: 1 }),
        }
    }

    fn best(&self) -> Option<Point> {
        let sure = self.finds.iter().filter(|find| find.times >= LEAST);
        sure.max_by_key(|find| find.times).map(Find::place)
    }
}

impl Find {
    fn place(&self) -> Point {
        Point::from(self.sum / f64::from(self.times))
    }
}

impl Behaviour for PoolSearch {
    type Observation = PoolSearchObservation;
    type Command = Thrust;
    type Outcome = PoolSearchOutcome;

    fn period(&self) -> f64 {
        self.survey.period()
    }

    fn step(&mut self, time: f64, seen: &PoolSearchObservation) -> Decision<Self> {
        let lanes = self.survey.step(time, &seen.survey)?;
        let place = self.look(seen)?;
        if let Some(place) = place {
            self.note(place);
        }
        if place.is_none() || lanes.is_break() {
            self.found = self.best();
        }
        Ok(match lanes {
            _ if self.found.is_some() => ControlFlow::Break(PoolSearchOutcome::Found),
            ControlFlow::Continue(thrust) => ControlFlow::Continue(thrust),
            ControlFlow::Break(SurveyOutcome::Covered) if 2 * self.dark > self.pictures => {
                ControlFlow::Break(PoolSearchOutcome::Blind)
            }
            ControlFlow::Break(SurveyOutcome::Covered) => ControlFlow::Break(PoolSearchOutcome::NotFound),
            ControlFlow::Break(SurveyOutcome::TimedOut) => ControlFlow::Break(PoolSearchOutcome::TimedOut),
            ControlFlow::Break(SurveyOutcome::Stopped) => ControlFlow::Break(PoolSearchOutcome::Stopped),
        })
    }
}

impl<R> Senses<R> for PoolSearch
where
    R: DepthSensor + Inertial + Odometry + DistanceSensors + Camera + Servos + ?Sized,
{
    fn prepare(&mut self, robot: &mut R) -> Result<()> {
        robot.set_resolution(Resolution::Qqvga)?;
        if self.camera.max_tilt > 0.0 { robot.set_servo(TILT, self.down) } else { Ok(()) }
    }

    fn sense(&mut self, robot: &mut R, time: f64, seen: &mut PoolSearchObservation) -> Result<()> {
        self.survey.sense(robot, time, &mut seen.survey)?;
        robot.image_into(&mut seen.image)
    }
}
