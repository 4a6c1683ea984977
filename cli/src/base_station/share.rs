//! Several cars on one road, and their base station.

use std::cell::RefCell;
use std::ops::ControlFlow;
use std::rc::Rc;

use roverlab::drive::traffic::{
    FreeDrive, FreeDriveRules, FreeDriveScore, RadioCar, RoadSharingParameters, RoadStation,
    RoadStationParameters, TrafficParameters,
};
use roverlab::geometry::Pose;
use roverlab::io::control::{Behaviour, Run};
use roverlab::io::{FleetIo, RobotIo};
use roverlab::vision::lane_markings::{RoadCamera, RoadModel};
use roverlab::world::RobotSpec;
use roverlab::world::road::Traffic;

use super::Args;
use super::scene::Setting;
use crate::common::Failure;

/// Duration without `--time-limit` (s).
const SECONDS: f64 = 60.0;
/// Interval between looks at the cars (s).
const LOOK: f64 = 0.05;
/// Time for which the station stops the cars, and within which all of them have to move again (s).
const HALT: f64 = 5.0;
const STARTS: f64 = 8.0;
/// Speed below which a car stands (m/s).
const STANDS: f64 = 0.02;

/// What came of a drive.
#[derive(Debug, Clone, Default)]
pub(super) struct Shared {
    pub(super) cars: Vec<Car>,
    pub(super) contacts: u64,
    /// Least distance between two cars (m).
    pub(super) least_gap: f64,
    /// Number of cars that the station heard last.
    pub(super) heard: usize,
    /// Whether the station has ordered to stand, time until all cars stood (s), and whether all of them drove
    /// on after the order.
    pub(super) is_ordered: bool,
    pub(super) stopped: Option<f64>,
    pub(super) went_on: Option<bool>,
    pub(super) time: f64,
}

/// A car's score and path.
#[derive(Debug, Clone)]
pub(super) struct Car {
    pub(super) score: FreeDriveScore,
    pub(super) trail: Vec<(f64, Pose)>,
}

/// Drives until the time is over.
pub(super) fn drive<'a>(
    args: &Args,
    setting: &Setting,
    fleet: &mut (dyn FleetIo<'a> + 'a),
    mut pace: impl FnMut(f64),
) -> Result<Shared, Failure> {
    for car in 0..setting.cars {
        control_car(setting, fleet, car)?;
    }
    let station = RoadStation::new(RoadStationParameters::default()).map_err(Failure::input)?;
    let station = Rc::new(RefCell::new(station));
    control_station(fleet, setting.cars, Rc::clone(&station))?;
    let seconds = args.common.time_limit.unwrap_or(SECONDS);
    let rules = FreeDriveRules { standing: f64::INFINITY, ..FreeDriveRules::default() };
    let mut watch = Watch {
        referees: (0..setting.cars)
            .map(|car| {
                let referee = FreeDrive::new(setting.course.clone(), &RobotSpec::road_car(), rules);
                referee.map(|referee| referee.starting_at(setting.starts[car]))
            })
            .collect::<Result<_, _>>()
            .map_err(Failure::input)?,
        trails: (0..setting.cars).map(|car| vec![(0.0, setting.scene.robots[car].pose)]).collect(),
        shared: Shared { least_gap: f64::INFINITY, ..Shared::default() },
        moved: vec![false; setting.cars],
    };
    while fleet.time()? + 0.5 * LOOK < seconds {
        let time = fleet.time()?;
        let since = time - args.stop_at;
        if since >= 0.0 {
            watch.shared.is_ordered = true;
            station.borrow_mut().stop(since < HALT);
        }
        fleet.run_for(LOOK)?;
        watch.look(fleet, since)?;
        pace(time);
    }
    let mut shared = watch.shared;
    shared.time = fleet.time()?;
    shared.went_on = shared.is_ordered.then(|| watch.moved.iter().all(|moved| *moved));
    shared.heard = station
        .borrow()
        .cars()
        .iter()
        .filter(|(_, heard, _)| shared.time - heard < RoadStationParameters::default().memory)
        .count();
    for car in 0..setting.cars {
        shared.contacts += u64::from(fleet.truth(car)?.contacts);
    }
    let cars = watch.referees.iter().zip(watch.trails);
    shared.cars = cars.map(|(referee, trail)| Car { score: *referee.score(), trail }).collect();
    Ok(shared)
}

/// The observers.
struct Watch {
    referees: Vec<FreeDrive>,
    trails: Vec<Vec<(f64, Pose)>>,
    shared: Shared,
    /// Cars that have moved after the order to go on.
    moved: Vec<bool>,
}

impl Watch {
    /// Observes the cars some time after the order to stand (s).
    fn look<'a>(&mut self, fleet: &mut (dyn FleetIo<'a> + 'a), since: f64) -> Result<(), Failure> {
        let time = fleet.time()?;
        let mut all_stand = true;
        for car in 0..self.trails.len() {
            let pose = fleet.pose(car)?;
            let (before, last) = self.trails[car].last().copied().unwrap_or_default();
            let speed = pose.distance_to(last.position()) / (time - before).max(1e-6);
            all_stand &= speed < STANDS;
            self.moved[car] |= (HALT..HALT + STARTS).contains(&since) && speed > STANDS;
            self.referees[car].see(time, &pose);
            self.trails[car].push((time, pose));
        }
        if all_stand && (0.0..HALT).contains(&since) {
            self.shared.stopped.get_or_insert(since);
        }
        let places: Vec<Pose> = self.trails.iter().filter_map(|trail| Some(trail.last()?.1)).collect();
        for (index, place) in places.iter().enumerate() {
            for other in &places[..index] {
                self.shared.least_gap = self.shared.least_gap.min(place.distance_to(other.position()));
            }
        }
        Ok(())
    }
}

fn control_car<'a>(
    setting: &Setting,
    fleet: &mut (dyn FleetIo<'a> + 'a),
    index: usize,
) -> Result<(), Failure> {
    let spec = RobotSpec::road_car();
    let camera = spec.camera.as_ref().map(RoadCamera::from);
    let camera = camera.ok_or_else(|| Failure::run("a car without a camera"))?;
    let course = &setting.course;
    let road = RoadModel {
        size: course.size,
        line_width: course.line_width,
        left_hand: course.traffic == Traffic::Left,
    };
    let start = course.start().inverse().compose(&setting.scene.robots[index].pose);
    let parameters = (TrafficParameters::default(), RoadSharingParameters::default());
    let mut car = RadioCar::new(camera, road, parameters, start).map_err(Failure::input)?;
    let mut run = Run::new(&car, f64::INFINITY)?;
    let period = car.period();
    let step = move |io: &mut dyn RobotIo| Ok(run.step(io, &mut car)?.map_break(|_| ()));
    fleet.control(index, period, Box::new(step))?;
    Ok(())
}

fn control_station<'a>(
    fleet: &mut (dyn FleetIo<'a> + 'a),
    index: usize,
    station: Rc<RefCell<RoadStation>>,
) -> Result<(), Failure> {
    let mut run = Run::new(&*station.borrow(), f64::INFINITY)?;
    let step = move |io: &mut dyn RobotIo| -> roverlab::io::Result<ControlFlow<()>> {
        Ok(run.step(io, &mut *station.borrow_mut())?.map_break(|_| ()))
    };
    fleet.control(index, RoadStationParameters::default().period, Box::new(step))?;
    Ok(())
}
