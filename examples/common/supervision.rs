//! Robots under the safety system: `--supervised`.

use std::sync::{Arc, Mutex, PoisonError};

use ambassador::Delegate;
use roverlab::drive::safety::{
    Beat, Causes, Panel, Requests, SafetyState, StopRecord, StoppingModel, Supervised, SupervisorParameters,
};
use roverlab::geometry::{Pose, Twist};
use roverlab::io::delegate::{
    GrayImage, RgbImage, ambassador_impl_Camera, ambassador_impl_Clock, ambassador_impl_Display,
    ambassador_impl_DistanceSensors, ambassador_impl_Drive, ambassador_impl_Encoders, ambassador_impl_Keys,
    ambassador_impl_Lidar, ambassador_impl_Motors, ambassador_impl_Radio, ambassador_impl_Servos,
};
use roverlab::io::{
    Camera, Clock, Display, DisplayOption, DistanceSensors, Drive, Encoders, Fill, Font, Key, Keys, Lidar,
    LidarScan, LidarSettings, Motors, Picture, Pixel, Psd, Radio, RadioMessage, Resolution, Result, Servos,
    Viewport,
};
use roverlab::world::Colour;
use serde_json::{Value, json};

use super::StageTruth;
use super::stage::Driven;

/// What the safety systems of a run have done, for its report.
#[derive(Debug, Clone, Default)]
pub(crate) struct Stops {
    all: Arc<Mutex<Vec<Stop>>>,
}

/// What a safety system has done.
#[derive(Debug, Clone, Copy)]
struct Stop {
    robot: usize,
    record: Option<StopRecord>,
    /// Metres that the robot went after the stop began, and those that it may go.
    metres: f64,
    bound: f64,
    /// Whether it stood at last.
    stood: bool,
}

impl Stops {
    /// What is to be told, if there was a safety system.
    pub(crate) fn take(&self) -> Option<Value> {
        let mut stops = std::mem::take(&mut *self.all.lock().unwrap_or_else(PoisonError::into_inner));
        stops.sort_by_key(|stop| stop.robot);
        (!stops.is_empty()).then(|| stops.iter().map(Stop::told).collect())
    }

    fn add(&self, stop: Stop) {
        self.all.lock().unwrap_or_else(PoisonError::into_inner).push(stop);
    }
}

impl Stop {
    fn told(&self) -> Value {
        let state = self.record.map(|record| format!("{:?}", record.state));
        let causes = self.record.map(|record| record.causes.names().collect::<Vec<_>>());
        json!({
            "state": state,
            "causes": causes,
            "time_s": self.record.map(|record| super::rounded(record.time)),
            "stop_mm": super::millimetres(self.metres),
            "bound_mm": super::millimetres(self.bound),
            "stood": self.stood,
        })
    }
}

/// What was true about a robot at a look.
#[derive(Debug, Clone, Copy, Default)]
struct Sight {
    time: f64,
    metres: f64,
    /// How fast it was on average since the look before.
    speed: f64,
}

/// How far a robot has truly gone.
#[derive(Debug, Clone, Copy, Default)]
struct Odometer {
    last: Sight,
    before: Sight,
    stop: Option<Began>,
}

/// How a stop began.
#[derive(Debug, Clone, Copy)]
struct Began {
    from: Sight,
    /// Whether nobody had looked for so long that the robot stopped by itself.
    alone: bool,
}

/// Seconds between two looks that are too many: the robot's own watchdog has stopped it meanwhile.
const GAP: f64 = DEADMAN;

impl Odometer {
    /// Takes in the way at a time, both true. The state is that after the look before.
    fn read(&mut self, time: f64, metres: f64, state: SafetyState) {
        let Self { last, before, .. } = *self;
        if state.is_stop() && self.stop.is_none() {
            // Behind a gap, the stop began in it.
            let alone = last.time - before.time >= GAP;
            self.stop = Some(Began { from: if alone { before } else { last }, alone });
        }
        if time > last.time {
            self.before = last;
            self.last = Sight { time, metres, speed: (metres - last.metres).abs() / (time - last.time) };
        }
    }
}

type Exchange = Box<dyn FnMut(f64, Beat) -> Panel + Send>;

/// A robot under the safety system, which is armed and started before the program gets it, and left standing, if there was a stop,
/// when the program lets go of it.
#[derive(Delegate)]
#[expect(clippy::duplicated_attributes, reason = "every capability has the same target")]
#[delegate(Clock, target = "inner")]
#[delegate(Drive, target = "inner")]
#[delegate(DistanceSensors, target = "inner")]
#[delegate(Lidar, target = "inner")]
#[delegate(Camera, target = "inner")]
#[delegate(Display, target = "inner")]
#[delegate(Keys, target = "inner")]
#[delegate(Radio, target = "inner")]
#[delegate(Motors, target = "inner")]
#[delegate(Servos, target = "inner")]
#[delegate(Encoders, target = "inner")]
struct Guarded {
    inner: Supervised<Driven, Exchange>,
    index: usize,
    odometer: Arc<Mutex<Odometer>>,
    stopping: StoppingModel,
    stops: Stops,
}

/// Seconds without a call after which a supervised robot stops by itself.
pub(crate) const DEADMAN: f64 = 0.3;
/// Seconds within which every robot comes to stand.
const PATIENCE: f64 = 15.0;

/// Puts a robot under the safety system.
pub(crate) fn guarded(
    robot: Driven,
    mut truth: StageTruth,
    index: usize,
    model: StoppingModel,
    stops: Stops,
) -> Result<Driven> {
    let odometer = Arc::new(Mutex::new(Odometer::default()));
    let read = Arc::clone(&odometer);
    let exchange: Exchange = Box::new(move |_, beat| {
        if let (Ok(time), Ok(robot)) = (truth.time(), truth.robot(index)) {
            let mut odometer = read.lock().unwrap_or_else(PoisonError::into_inner);
            odometer.read(time, robot.path_length, beat.state);
        }
        // Armed, then started, each for as long as it takes.
        let requests = Requests {
            arm: beat.count > 1 && beat.state == SafetyState::Manual,
            start: beat.state == SafetyState::Armed,
            disarm: false,
        };
        Panel { heartbeat: Some(beat.count), requests, ..Panel::default() }
    });
    let parameters = SupervisorParameters { speed_error: model.error, ..SupervisorParameters::default() };
    let stopping = parameters.stopping(model.lag, model.deceleration);
    let mut inner = Supervised::new(robot, exchange, parameters)?;
    inner.wait(0.1)?;
    Ok(Box::new(Guarded { inner, index, odometer, stopping, stops }))
}

impl Drop for Guarded {
    fn drop(&mut self) {
        let mut waited = 0.0;
        let mut stood = false;
        // What made the program end may be known to the safety system only when time passes.
        while (waited == 0.0 || self.inner.state().is_stop()) && !stood && waited < PATIENCE {
            // What fails is the fault's; time passes all the same.
            let before = self.read().last.metres;
            let _ = self.inner.wait(0.1);
            stood = (self.read().last.metres - before).abs() < 1e-5;
            waited += 0.1;
        }
        let odometer = self.read();
        let began = odometer.stop.unwrap_or(Began { from: odometer.last, alone: false });
        let record = self.inner.last_stop();
        // Without a link, or while a call hangs, the brake is in the hands of the robot's own watchdog.
        let alone = began.alone || record.is_some_and(|record| record.causes.has(Causes::LINK));
        let reaction = self.stopping.reaction + if alone { DEADMAN } else { 0.0 };
        // Until it does, the robot follows its last command, and may speed up.
        let asked = if alone { self.inner.asked().unwrap_or(0.0) } else { 0.0 };
        self.stops.add(Stop {
            robot: self.index,
            record,
            metres: odometer.last.metres - began.from.metres,
            bound: StoppingModel { reaction, ..self.stopping }.distance(began.from.speed.max(asked)),
            stood,
        });
    }
}

impl Guarded {
    fn read(&self) -> Odometer {
        *self.odometer.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
