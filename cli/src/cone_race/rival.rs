//! A race for places between two cars of different kinds.

use std::cell::{Cell, RefCell};
use std::ops::ControlFlow;
use std::rc::Rc;

use roverlab::geometry::{Point, Pose};
use roverlab::io::control::{self, Behaviour, Run, until};
use roverlab::io::log::{FleetIo, Header, Log, LogWriter, Player};
use roverlab::io::sim::{RobotTruth, TICK};
use roverlab::io::{self, LidarSettings, RobotIo};
use roverlab::race::{GapDriver, LineTracker, PlaceReferee, RaceOutcome, RacePhase, Racer};
use roverlab::world::{RobotSpec, Scene};

use super::race::{Ending, Outcome, Second, Settings};
use crate::common::{Failure, Stage};
use crate::cones::{Course, Passed};

/// The program of the other car.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Rival {
    /// The book's program, at 3 m/s: it starts ahead.
    Gap,
    /// This racer, taught by a recording of its own first lap, which it has driven alone: it starts behind.
    Recorded,
}

/// Distance of the first car on the grid to the line, and between the cars (m).
const TO_LINE: f64 = 6.0;
const BETWEEN: f64 = 9.0;
/// Speed of the book's program (m/s), as in `cone_drive`.
const BOOKS_SPEED: f64 = 3.0;
/// Length of a racing car (m).
const CAR: f64 = 2.6;
/// Number of ticks between two points of a path.
const STEP: u32 = 5;

/// What a race for places adds to the result of the first car.
#[derive(Debug, Clone)]
pub(crate) struct Contest {
    pub(crate) outcome: Outcome,
    /// Place of each car.
    pub(crate) places: Vec<usize>,
    /// Distance of the first car ahead of the second one at the end (m).
    pub(crate) lead: f64,
    /// Overtakings: time (s), and whether by the rival.
    pub(crate) overtakings: Vec<(f64, bool)>,
    pub(crate) rival_off_course: usize,
}

impl Contest {
    /// Whether the faster car, which starts behind, is ahead at the end.
    pub(crate) fn is_passed(&self, rival: Rival) -> bool {
        self.has_passed(rival.is_faster())
    }

    /// Whether this car, or the rival, has overtaken the other one and is ahead at the end.
    pub(crate) fn has_passed(&self, rival: bool) -> bool {
        self.places[usize::from(rival)] == 1 && self.overtakings.iter().any(|(_, by)| *by == rival)
    }
}

impl Rival {
    /// Whether it starts behind and should pass.
    fn is_faster(self) -> bool {
        self == Self::Recorded
    }

    /// Starts of the first car and its rival.
    fn grid(self, course: &Course) -> [Pose; 2] {
        let (front, back) = (course.start, course.ahead(-TO_LINE - BETWEEN));
        if self.is_faster() { [front, back] } else { [back, front] }
    }

    /// Cones and cars.
    pub(crate) fn scene(self, course: &Course) -> Scene {
        course.scene(&self.grid(course))
    }
}

/// Races for places on a course.
pub(crate) fn race<'a>(
    course: &Course,
    settings: &Settings,
    rival: Rival,
    fleet: &mut (dyn FleetIo<'a> + 'a),
) -> Result<Contest, Failure> {
    let limit = settings.limit.unwrap_or(course.corridor.length() * (1.0 + settings.laps as f64 / 2.0));
    // The referee ends the race, so no car counts as far as its own laps.
    let laps = settings.laps + 2;
    let racer = Rc::new(RefCell::new(Racer::new(course.parameters(laps))?));
    let ended = Rc::new(Cell::new(None));
    let starts = rival.grid(course);
    control_racer(fleet, 0, Rc::clone(&racer), limit, Rc::clone(&ended))?;
    match rival {
        Rival::Gap => control_gap(fleet, limit)?,
        Rival::Recorded => {
            let mut taught = taught(course, settings)?;
            taught.start_again(course.start.inverse().compose(&starts[1]));
            let taught = Rc::new(RefCell::new(taught));
            control_racer(fleet, 1, taught, limit, Rc::default())?;
        }
    }
    let mut stand = Stand::new(course, settings.laps)?;
    let driven = stand.watch(fleet, limit);
    let ending = match (driven, ended.get()) {
        (Err(error), _) => Err(Failure::from(error).to_string()),
        (Ok(()), Some(RaceOutcome::Lost)) => Ok(Ending::Lost),
        (Ok(()), _) if stand.referee.is_over() => Ok(Ending::Finished),
        (Ok(()), _) => Ok(Ending::TimedOut),
    };
    let racer = racer.borrow();
    let line = racer.line().filter(|line| line.is_closed()).map_or(&[][..], LineTracker::points);
    stand.contest(ending, line.iter().map(|point| starts[0].to_world(*point)).collect(), fleet)
}

/// Lets a racer drive a car.
fn control_racer<'a>(
    fleet: &mut (dyn FleetIo<'a> + 'a),
    car: usize,
    racer: Rc<RefCell<Racer>>,
    limit: f64,
    ended: Rc<Cell<Option<RaceOutcome>>>,
) -> Result<(), Failure> {
    let mut run = Run::new(&*racer.borrow(), limit).map_err(Failure::run)?;
    let period = racer.borrow().period();
    let step = move |car: &mut dyn RobotIo| {
        let decision = run.step(car, &mut *racer.borrow_mut())?;
        if let ControlFlow::Break(outcome) = decision {
            ended.set(Some(outcome));
        }
        Ok(decision.map_break(|_| ()))
    };
    fleet.control(car, period, Box::new(step)).map_err(Failure::run)
}

/// Lets the book's program drive the second car.
fn control_gap<'a>(fleet: &mut (dyn FleetIo<'a> + 'a), limit: f64) -> Result<(), Failure> {
    let mut driver = GapDriver::with_speed(BOOKS_SPEED / RobotSpec::race_car().drive.top_speed())?;
    let mut run = Run::new(&driver, limit).map_err(Failure::run)?;
    let period = driver.period();
    let mut is_set = false;
    let step = move |car: &mut dyn RobotIo| {
        if !std::mem::replace(&mut is_set, true) {
            car.configure_lidar(LidarSettings {
                field_of_view: std::f64::consts::PI,
                tilt: 0.0,
                points: 180,
            })?;
        }
        Ok(run.step(car, &mut driver)?.map_break(|_| ()))
    };
    fleet.control(1, period, Box::new(step)).map_err(Failure::run)
}

/// A racer that knows the track from a recording of a first lap, which it drives alone.
fn taught(course: &Course, settings: &Settings) -> Result<Racer, Failure> {
    let learn = |car: &mut dyn RobotIo| -> Result<Racer, Failure> {
        let mut racer = Racer::new(course.parameters(settings.laps + 2))?;
        let limit = 2.0 * course.corridor.length();
        control::run(car, &mut racer, limit, |_, racer: &mut Racer, _| {
            until(racer.phase() == RacePhase::Racing)
        })?;
        Ok(racer)
    };
    let stage = Stage::simulated(&course.scene(&[course.start]), settings.options(), Vec::new())?;
    let writer = LogWriter::new(Vec::new(), &Header::new("cone_race", [""])).map_err(Failure::run)?;
    let mut car = writer.recorder(stage.robot(0)?, 0);
    learn(&mut car)?;
    drop(car);
    let log = Log::read(writer.finish().map_err(Failure::run)?).map_err(Failure::run)?;
    learn(&mut Player::new(&log).robot(0).map_err(Failure::run)?)
}

/// Watches both cars, with one referee.
struct Stand {
    referee: PlaceReferee,
    cones: Vec<Point>,
    trails: [Vec<Passed>; 2],
    touched: bool,
}

impl Stand {
    fn new(course: &Course, laps: usize) -> Result<Self, Failure> {
        Ok(Self {
            referee: PlaceReferee::new(&course.corridor, Course::wheels(), 2, laps, CAR)?,
            cones: course.cones.iter().map(|cone| cone.position).collect(),
            trails: Default::default(),
            touched: false,
        })
    }

    /// Lets both drive until the referee ends the race.
    fn watch<'a>(&mut self, fleet: &mut (dyn FleetIo<'a> + 'a), limit: f64) -> io::Result<()> {
        let mut before = [0.0; 2];
        let mut tick = 0;
        while !self.referee.is_over() && fleet.time()? < limit {
            fleet.run_for(TICK)?;
            let (time, cars) = (fleet.time()?, [fleet.truth(0)?, fleet.truth(1)?]);
            let fallen = |car: &RobotTruth| {
                car.contact_places.iter().filter(|place| self.cones.contains(place)).count()
            };
            let hits = [fallen(&cars[0]), fallen(&cars[1])];
            self.touched |= cars.iter().zip(hits).any(|(car, hits)| car.contact_places.len() > hits);
            self.referee.see(time, &[cars[0].pose, cars[1].pose], &hits);
            tick += 1;
            if tick % STEP == 0 {
                for ((trail, car), before) in self.trails.iter_mut().zip(&cars).zip(&mut before) {
                    let speed = (car.path_length - *before) / (TICK * f64::from(STEP));
                    *before = car.path_length;
                    trail.push(Passed { time, pose: car.pose, speed });
                }
            }
        }
        Ok(())
    }

    fn contest<'a>(
        self,
        ending: Result<Ending, String>,
        line: Vec<Point>,
        fleet: &mut (dyn FleetIo<'a> + 'a),
    ) -> Result<Contest, Failure> {
        let truth = fleet.truth(0).map_err(Failure::run)?;
        let [verdict, other] = [0, 1].map(|car| self.referee.score(car).cloned().unwrap_or_default());
        let way = |car| self.referee.distance(car).unwrap_or_default();
        let [trail, rivals] = self.trails.clone();
        Ok(Contest {
            places: self.referee.places(),
            lead: way(0) - way(1),
            overtakings: self.referee.overtakings().iter().map(|by| (by.time, by.cars[0] == 1)).collect(),
            rival_off_course: other.off_course,
            outcome: Outcome {
                verdict,
                ending,
                time: fleet.time().map_err(Failure::run)?,
                trail,
                line,
                over_optimum: Vec::new(),
                standing: self.cones.iter().map(|cone| !truth.contact_places.contains(cone)).collect(),
                touched: self.touched,
                other: Some(Second { cones_hit: other.cones_hit, trail: rivals }),
                truth,
            },
        })
    }
}
