//! Robots under the safety system: `--supervised`.

use std::sync::{Arc, Mutex, PoisonError};

use ambassador::Delegate;
use roverlab::geometry::{Pose, Twist, Vector3, angle_difference};
use roverlab::io::delegate::{
    GrayImage, RgbImage, ambassador_impl_Camera, ambassador_impl_Clock, ambassador_impl_DepthSensor,
    ambassador_impl_Display, ambassador_impl_DistanceSensors, ambassador_impl_Drive,
    ambassador_impl_Encoders, ambassador_impl_Inertial, ambassador_impl_Keys, ambassador_impl_Lidar,
    ambassador_impl_Manoeuvres, ambassador_impl_Motors, ambassador_impl_Odometry, ambassador_impl_Radio,
    ambassador_impl_Servos, ambassador_impl_StallDetector,
};
use roverlab::io::{
    Attitude, Camera, Clock, DepthSensor, Display, DisplayImage, DisplayOption, DistanceSensors, Drive,
    Encoders, Fill, Font, Inertial, Key, Keys, Lidar, LidarScan, LidarSettings, Manoeuvres, Motors, Odometry,
    Pixel, Psd, Radio, RadioMessage, Resolution, Result, Servos, StallDetector, Viewport,
};
use roverlab::safety::{
    Causes, Heartbeat, Panel, Requests, SafetyState, StopRecord, StoppingModel, Supervised,
    SupervisedParameters,
};
use roverlab::world::Colour;
use serde_json::{Value, json};

use super::StageTruth;
use super::stage::Driven;

/// Actions of a run's safety systems, for its report.
#[derive(Debug, Clone, Default)]
pub(crate) struct Stops {
    all: Arc<Mutex<Vec<Stop>>>,
}

/// A stop by a safety system.
#[derive(Debug, Clone, Copy)]
struct Stop {
    robot: usize,
    record: Option<StopRecord>,
    /// True start time (s).
    time: Option<f64>,
    /// Distance travelled after the start of the stop, and its bound (m).
    metres: f64,
    bound: f64,
    fault: Option<Before>,
    /// Whether the robot finally stood.
    stood: bool,
}

/// The fault before a stop.
#[derive(Debug, Clone, Copy)]
struct Before {
    time: f64,
    /// Distance from the last look before it until the robot stood (m).
    metres: f64,
    /// Wheel speed at the fault, and maximum speed between fault and stop (m/s).
    rolling: f64,
    fastest: f64,
}

impl Stops {
    /// The report, if there was a safety system.
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
            "time_s": self.time.or(self.record.map(|record| record.time)).map(super::rounded),
            "stop_mm": super::millimetres(self.metres),
            "bound_mm": super::millimetres(self.bound),
            "stood": self.stood,
            "fault_s": self.fault.map(|fault| super::rounded(fault.time)),
            "since_fault_mm": self.fault.map(|fault| super::millimetres(fault.metres)),
            "rolling_mm_s": self.fault.map(|fault| super::millimetres(fault.rolling)),
            "fastest_mm_s": self.fault.map(|fault| super::millimetres(fault.fastest)),
        })
    }
}

/// True state of a robot at a look.
#[derive(Debug, Clone, Copy, Default)]
struct Sight {
    time: f64,
    metres: f64,
    heading: f64,
    /// Mean speed since the previous look, and wheel speed including turning (m/s).
    speed: f64,
    rolling: f64,
}

/// Wheel travel per radian of turning (m/rad).
const ARM: f64 = 0.1;

impl Sight {
    /// The state at a later time.
    fn next(self, time: f64, metres: f64, heading: f64) -> Self {
        let passed = time - self.time;
        let turned = angle_difference(heading, self.heading).abs();
        let speed = (metres - self.metres).abs() / passed;
        Self { time, metres, heading, speed, rolling: speed + ARM * turned / passed }
    }
}

/// True distance travelled by a robot.
#[derive(Debug, Clone, Copy, Default)]
struct Odometer {
    last: Sight,
    before: Sight,
    stop: Option<Began>,
    /// Time of the fault, the last look before it, and the maximum speed from then on to the stop.
    fault: Option<f64>,
    fault_from: Option<Sight>,
    fastest: f64,
}

/// Start of a stop.
#[derive(Debug, Clone, Copy)]
struct Began {
    time: f64,
    state: SafetyState,
    from: Sight,
    /// Whether the looks had paused for so long that the robot stopped by itself.
    alone: bool,
}

/// Gap between two looks after which the robot's own watchdog has stopped it (s).
const GAP: f64 = DEADMAN;

impl Odometer {
    /// Updates the true motion at a time. `state` is that after the previous look.
    fn read(&mut self, time: f64, (metres, heading): (f64, f64), state: SafetyState) {
        let Self { last, before, .. } = *self;
        if state.is_stop() && self.stop.is_none() {
            // After a gap, the stop began within it.
            let alone = last.time - before.time >= GAP;
            self.stop =
                Some(Began { time: last.time, state, from: if alone { before } else { last }, alone });
        }
        if time > last.time {
            self.before = last;
            self.last = last.next(time, metres, heading);
        }
        if self.fault_from.is_none() && self.fault.is_some_and(|fault| time > fault) {
            self.fault_from = Some(last);
            self.fastest = last.speed;
        }
        if self.fault_from.is_some() && self.stop.is_none() {
            self.fastest = self.fastest.max(self.last.speed);
        }
    }
}

type Exchange = Box<dyn FnMut(f64, Heartbeat) -> Panel + Send>;

/// A robot under the safety system, which is armed and started before the program gets it. When the program
/// drops the robot after a stop, it is left standing.
#[derive(Delegate)]
#[expect(clippy::duplicated_attributes, reason = "every capability has the same target")]
#[delegate(Clock, target = "inner")]
#[delegate(Drive, target = "inner")]
#[delegate(Odometry, target = "inner")]
#[delegate(Manoeuvres, target = "inner")]
#[delegate(StallDetector, target = "inner")]
#[delegate(DistanceSensors, target = "inner")]
#[delegate(Lidar, target = "inner")]
#[delegate(Camera, target = "inner")]
#[delegate(Display, target = "inner")]
#[delegate(Keys, target = "inner")]
#[delegate(Radio, target = "inner")]
#[delegate(Motors, target = "inner")]
#[delegate(Servos, target = "inner")]
#[delegate(Encoders, target = "inner")]
#[delegate(DepthSensor, target = "inner")]
#[delegate(Inertial, target = "inner")]
struct Guarded {
    inner: Supervised<Driven, Exchange>,
    index: usize,
    odometer: Arc<Mutex<Odometer>>,
    parameters: SupervisedParameters,
    model: StoppingModel,
    stops: Stops,
}

/// Time without a call after which a supervised robot stops by itself (s).
pub(crate) const DEADMAN: f64 = 0.3;
/// Time within which every robot stands (s).
const PATIENCE: f64 = 15.0;
/// Maximum number of waits for that: failing waits may take no time.
const ROUNDS: usize = 2000;
/// Speed below which a robot stands (m/s).
const STANDS: f64 = 1e-4;

/// Puts a robot under the safety system; `fault` is the time of its first fault (s).
pub(crate) fn guarded(
    robot: Driven,
    mut truth: StageTruth,
    index: usize,
    (model, fault): (StoppingModel, Option<f64>),
    stops: Stops,
) -> Result<Driven> {
    let odometer = Arc::new(Mutex::new(Odometer { fault, ..Odometer::default() }));
    let read = Arc::clone(&odometer);
    let exchange: Exchange = Box::new(move |_, heartbeat| {
        if let (Ok(time), Ok(robot)) = (truth.time(), truth.robot(index)) {
            let mut odometer = read.lock().unwrap_or_else(PoisonError::into_inner);
            odometer.read(time, (robot.path_length, robot.pose.heading), heartbeat.state);
        }
        // Armed, then started, each for as long as it takes.
        let requests = Requests {
            arm: heartbeat.count > 1 && heartbeat.state == SafetyState::Manual,
            start: heartbeat.state == SafetyState::Armed,
            disarm: false,
        };
        Panel { heartbeat: Some(heartbeat.count), requests, ..Panel::default() }
    });
    let parameters = SupervisedParameters { speed_error: model.error, ..SupervisedParameters::default() };
    let mut inner = Supervised::new(robot, exchange, parameters.clone())?;
    inner.wait(0.1)?;
    Ok(Box::new(Guarded { inner, index, odometer, parameters, model, stops }))
}

impl Drop for Guarded {
    fn drop(&mut self) {
        let stood = self.stands_at_last();
        let odometer = self.read();
        let record = self.inner.last_stop();
        let metres = |from: Sight| odometer.last.metres - from.metres;
        let state = self.inner.state();
        let began = odometer.stop.unwrap_or(Began { time: 0.0, state, from: odometer.last, alone: false });
        let fault = odometer.fault.zip(odometer.fault_from).map(|(time, from)| Before {
            time,
            metres: metres(from),
            rolling: from.rolling,
            fastest: odometer.fastest,
        });
        self.stops.add(Stop {
            robot: self.index,
            record,
            time: odometer.stop.map(|began| began.time),
            metres: metres(began.from),
            bound: self.bound(began, record),
            fault,
            stood,
        });
    }
}

impl Guarded {
    /// Lets a stop come to its end. Returns whether the robot stands then.
    ///
    /// Uses true time: a failing wait ends early, and a clock may stop.
    fn stands_at_last(&mut self) -> bool {
        let from = self.read().last.time;
        for _ in 0..ROUNDS {
            // Failures come from the fault; time passes nevertheless, unless the world has ended.
            let _ = self.inner.wait(0.1);
            let now = self.read().last;
            if now.speed < STANDS {
                return true;
            }
            // The safety system may learn only after some time what ended the program.
            if !self.inner.state().is_stop() || now.time - from > PATIENCE {
                return false;
            }
        }
        false
    }

    /// Maximum distance of the robot from where a stop began (m).
    fn bound(&self, began: Began, record: Option<StopRecord>) -> f64 {
        let StoppingModel { lag, deceleration, .. } = self.model;
        let stopping = self.parameters.stopping_in(began.state, lag, deceleration);
        // Without a link, or during a hanging call, the robot's own watchdog brakes.
        let alone = began.alone || record.is_some_and(|record| record.causes.has(Causes::LINK));
        let reaction = stopping.reaction + if alone { DEADMAN } else { 0.0 };
        // Until then the robot follows its last command, and may accelerate.
        let asked = if alone { self.inner.asked().unwrap_or(0.0) } else { 0.0 };
        StoppingModel { reaction, ..stopping }.distance(began.from.speed.max(asked))
    }

    fn read(&self) -> Odometer {
        *self.odometer.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
