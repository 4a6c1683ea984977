//! The safety system allocates nothing once it is there. A program of its own, as it counts all that is
//! allocated.

#![allow(unsafe_code, reason = "an allocator is unsafe to write")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use roverlab::geometry::{Point, Pose, Twist};
use roverlab::io::{Clock, DistanceSensors, Drive, Lidar, LidarScan, LidarSettings, Odometry, Psd, Result};
use roverlab::safety::{
    BaseStation, Causes, Heartbeat, Panel, Requests, SafetyState, Station, Supervised, SupervisedParameters,
};

/// Counts what the present thread allocates.
struct Counting;

thread_local! {
    static ALLOCATED: Cell<usize> = const { Cell::new(0) };
}

fn count() {
    // A thread that ends has nothing to count with.
    let _ = ALLOCATED.try_with(|count| count.set(count.get() + 1));
}

unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

/// How often something allocates.
fn allocations(action: impl FnOnce()) -> usize {
    let before = ALLOCATED.get();
    action();
    ALLOCATED.get() - before
}

/// A robot that allocates nothing itself, and drives as it is told.
#[derive(Debug, Default)]
struct Plain {
    time: f64,
    pose: Pose,
    twist: Twist,
}

impl Clock for Plain {
    fn now(&mut self) -> Result<f64> {
        Ok(self.time)
    }

    fn wait(&mut self, seconds: f64) -> Result<()> {
        self.time += seconds;
        self.pose.x += self.twist.linear * seconds;
        Ok(())
    }

    fn peek_time(&mut self) -> Result<f64> {
        Ok(self.time)
    }
}

impl Drive for Plain {
    fn set_speed(&mut self, twist: Twist) -> Result<()> {
        self.twist = twist;
        Ok(())
    }
}

impl Odometry for Plain {
    fn speed(&mut self) -> Result<Twist> {
        Ok(self.twist)
    }

    fn pose(&mut self) -> Result<Pose> {
        Ok(self.pose)
    }

    fn set_pose(&mut self, pose: Pose) -> Result<()> {
        self.pose = pose;
        Ok(())
    }
}

impl Lidar for Plain {
    fn scan_into(&mut self, scan: &mut LidarScan) -> Result<()> {
        // The caller's memory is used again.
        scan.ranges.resize(180, 0.0);
        scan.ranges.fill(3.0 + self.time);
        Ok(())
    }

    fn configure_lidar(&mut self, _: LidarSettings) -> Result<()> {
        Ok(())
    }
}

impl DistanceSensors for Plain {
    fn distance(&mut self, sensor: Psd) -> Result<f64> {
        Ok(1.0 + self.time + f64::from(sensor.0))
    }
}

/// A base station that is in order, and whoever else sits there.
struct Crew {
    base: BaseStation,
    change: fn(f64, &mut Panel),
}

impl Station for Crew {
    fn exchange(&mut self, now: f64, heartbeat: Heartbeat) -> Panel {
        self.base.look(now);
        self.base.panel.requests = Requests { arm: now > 0.03, start: now > 0.07, disarm: false };
        (self.change)(now, &mut self.base.panel);
        self.base.exchange(now, heartbeat)
    }
}

fn drive(car: &mut Supervised<Plain, Crew>, scan: &mut LidarScan, steps: usize) {
    for _ in 0..steps {
        let _ = (car.scan_into(scan), car.pose(), car.speed(), car.set_speed(Twist::new(0.5, 0.1)));
        for sensor in 0..=u8::MAX {
            let _ = car.distance(Psd(sensor));
        }
        let _ = car.wait(0.05);
    }
}

/// Readings of all sensors there can be, looks, stops and what follows them.
#[test]
fn supervision_allocates_nothing_after_it_was_made() {
    type Change = fn(f64, &mut Panel);
    let changes: [(Change, SafetyState, Causes); 4] = [
        (
            |now, panel| panel.emergency_button = now > 2.0,
            SafetyState::EmergencyStop,
            Causes::EMERGENCY_BUTTON,
        ),
        (|now, panel| panel.brake = if now > 2.0 { 0.5 } else { 0.0 }, SafetyState::Manual, Causes::DRIVER),
        (|now, panel| panel.sensors_checked = now > 2.0, SafetyState::Auto, Causes::NONE),
        // The fence ends at 1.8 m.
        (|_, _| {}, SafetyState::SafeStop, Causes::OUTSIDE_FENCE),
    ];
    for (change, state, cause) in changes {
        let fence =
            [(-1.0, -1.0), (1.8, -1.0), (1.8, 1.0), (-1.0, 1.0)].map(|(x, y)| Point::new(x, y)).to_vec();
        let steps = if cause == Causes::OUTSIDE_FENCE { 120 } else { 60 };
        let parameters = SupervisedParameters { fence, ..SupervisedParameters::default() };
        let crew = Crew { base: BaseStation::new(0.5).unwrap(), change };
        let mut car = Supervised::new(Plain::default(), crew, parameters).unwrap();
        let mut scan = LidarScan { ranges: Vec::with_capacity(180), ..LidarScan::default() };
        assert_eq!(allocations(|| drive(&mut car, &mut scan, steps)), 0, "{state:?}");
        assert_eq!((car.state(), car.causes()), (state, cause), "{:?}", car.last_stop());
    }
}

/// That something is counted at all.
#[test]
fn what_allocates_is_counted() {
    assert!(allocations(|| drop(std::hint::black_box(vec![1_u8; 100]))) > 0);
    let made = allocations(|| {
        let crew = Crew { base: BaseStation::new(0.5).unwrap(), change: |_, _| {} };
        drop(Supervised::new(Plain::default(), crew, SupervisedParameters::default()));
    });
    assert!(made > 0, "a supervisor is made of memory");
}
