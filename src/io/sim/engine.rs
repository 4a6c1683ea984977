mod radio;

use std::sync::Arc;

use image::RgbImage;
use radio::Radio;

use super::body::Body;
use super::camera::{CameraDevice, Moment, Studio};
use super::drive_mechanics::{AHEAD, Drift};
use super::inertial_unit::InertialUnit;
use super::lockstep::{Ticking, no_robot};
use super::machine::Machine;
use super::movable::{Movable, movables};
use super::noise::{make_noisy, noisy};
use super::options::ticks_in;
use super::terrain::Hills;
use super::watch::{Onlooking, Watcher};
use super::{LONGEST, SimOptions, TICKS_PER_SECOND, TrailPoint};
use crate::geometry::{Pose, Pose3, Twist, Vector3, units};
use crate::io::reading::{point_in_words, pose_in_words};
use crate::io::{Attitude, Error, ErrorKind, Key, LidarScan, LidarSettings, Psd, Resolution, Result};
use crate::kinematics::Displacement;
use crate::parameter::{require_finite, require_positive};
use crate::random::Stream;
use crate::world::space::{Contact, Solid, SolidId, Space};
use crate::world::{RobotPlacement, Scene, World};

/// State of a world and its robots, and its evolution in time.
#[derive(Debug)]
pub(super) struct Engine {
    pub(super) space: Space,
    /// The robots, each in two parts: what moves, which a fleet needs in every tick, and the rest.
    pub(super) bodies: Vec<Body>,
    pub(super) machines: Vec<Machine>,
    pub(super) options: SimOptions,
    /// Ticks since the start.
    pub(super) tick: u64,
    /// What the drives do in the next ticks, tick by tick.
    drifts: Vec<Drift>,
    /// Whether no drive depends on its robot's motion.
    pub(super) independent: bool,
    pub(super) contacts: Vec<Contact>,
    pub(super) movables: Vec<Movable>,
    radio: Radio,
    moves: Vec<Move>,
    studio: Box<Studio>,
    /// Hills instead of a level floor.
    pub(super) hills: Option<Box<Hills>>,
    trail_ticks: Option<u64>,
    watcher: Option<Box<dyn Watcher>>,
}

/// A move requested by a robot's program for the next tick.
#[derive(Debug)]
struct Move {
    by: usize,
    thing: Thing,
    pose: Pose,
    /// Height above the floor from which a robot drops on hills (m).
    z: f64,
}

/// A robot or an object, by its index in the scene.
#[derive(Debug, Clone, Copy)]
pub(super) enum Thing {
    Robot(usize),
    Object(usize),
}

impl Ticking for Engine {
    fn time(&self) -> u64 {
        self.tick
    }

    fn run(&mut self, ticks: u64) {
        Engine::run(self, ticks);
    }
}

impl Engine {
    pub(super) fn new(scene: &Scene, options: SimOptions) -> Result<Self> {
        options.validate()?;
        check_world(&scene.world)?;
        let mut space = Space::new(&scene.world.walls);
        let objects: Vec<SolidId> =
            scene.world.objects.iter().map(|object| space.add(Solid::from(object))).collect();
        let root = Stream::new(options.seed);
        let mut bodies = Vec::with_capacity(scene.robots.len());
        let mut machines = Vec::with_capacity(scene.robots.len());
        for (index, placement) in scene.robots.iter().enumerate() {
            check_placement(placement)?;
            let solid = space.add(Solid::from(placement));
            bodies.push(Body::new(placement, solid));
            let alike = machines.last().filter(|last: &&Machine| Arc::ptr_eq(&last.spec, &placement.spec));
            let stream = root.child("robot", index as u64);
            machines.push(Machine::new(placement, alike, &options, &stream)?);
        }
        let robots: Vec<SolidId> = bodies.iter().map(|body| body.solid).collect();
        let studio = Box::new(Studio::new(scene, &objects, &robots));
        let independent = machines.iter().all(|machine| machine.drive.is_independent());
        let trail_ticks = options.trail_interval.map(ticks_in);
        let radio = Radio::new(options.radio_loss, root.child("radio", 0));
        let mut engine = Self {
            radio,
            space,
            bodies,
            machines,
            options,
            tick: 0,
            drifts: Vec::new(),
            independent,
            contacts: Vec::new(),
            movables: movables(&scene.world, &objects),
            moves: Vec::new(),
            studio,
            hills: None,
            trail_ticks,
            watcher: None,
        };
        engine.hills = Hills::of(&scene.world, &scene.robots, &mut engine.machines, engine.options.seed)?;
        engine.stand_on_hills();
        (0..engine.bodies.len()).for_each(|index| engine.begin_inertial(index));
        Ok(engine)
    }

    /// Puts everything in a world with hills on the ground.
    fn stand_on_hills(&mut self) {
        let Some(hills) = &mut self.hills else { return };
        for movable in &self.movables {
            let place = self.space.solid(movable.solid).pose.position();
            self.space.set_level(movable.solid, hills.level(place, movable));
        }
        hills.yield_to(&mut self.bodies, &self.machines, &mut self.space);
    }

    /// Puts an object somewhere else, at its height above the ground there.
    pub(super) fn put(&mut self, object: &Movable, pose: Pose) {
        self.space.set_pose(object.solid, pose);
        if let Some(hills) = &self.hills {
            self.space.set_level(object.solid, hills.level(pose.position(), object));
        }
    }

    /// Pose of a robot in space.
    pub(super) fn pose_in_space(&self, robot: usize) -> Result<Pose3> {
        let body = self.body(robot)?;
        Ok(pose_in_space(self.hills.as_deref(), robot, body.pose(), body.span.bottom))
    }

    /// Time since the start, at the present tick (s).
    pub(super) fn time(&self) -> f64 {
        // The quotient is the number nearest to the time; the product with 0.01 is not always.
        self.tick as f64 / TICKS_PER_SECOND
    }

    /// A robot by its index in the scene.
    pub(super) fn body(&self, robot: usize) -> Result<&Body> {
        self.bodies.get(robot).ok_or_else(|| no_robot(robot, self.bodies.len()))
    }

    pub(super) fn press_key(&mut self, robot: usize, time: f64, key: Key) -> Result<()> {
        if time.is_nan() || time.abs() > LONGEST {
            let expected = format!("at most {LONGEST} s");
            return Err(Error::invalid_input("time of the key press", time, &expected));
        }
        let robots = self.bodies.len();
        let machine = self.machines.get_mut(robot).ok_or_else(|| no_robot(robot, robots))?;
        machine.schedule_key(time, key);
        Ok(())
    }

    /// Requests a move for the next tick.
    pub(super) fn place_later(&mut self, by: usize, thing: Thing, pose: Pose, z: f64) {
        self.moves.push(Move { by, thing, pose, z });
    }

    /// Executes the moves of this tick, in an order independent of thread scheduling.
    fn make_moves(&mut self) {
        let mut moves = std::mem::take(&mut self.moves);
        moves.sort_by_key(|wish| wish.by);
        for Move { thing, pose, z, .. } in moves {
            match thing {
                Thing::Robot(robot) => self.place(robot, pose, z),
                Thing::Object(object) => self.place_object(object, pose),
            }
        }
    }

    /// Sets the watcher from now on, in place of the previous one.
    pub(super) fn watch(&mut self, watcher: Box<dyn Watcher>) {
        self.watcher = Some(watcher);
        self.show();
    }

    /// Shows the world to the watcher.
    fn show(&mut self) {
        if let Some(mut watcher) = self.watcher.take() {
            watcher.tick(&mut Onlooking::new(self));
            self.watcher = Some(watcher);
        }
    }

    /// Fails without an object of this index.
    pub(super) fn check_object(&self, object: usize) -> Result<()> {
        let objects = self.movables.len();
        if object < objects {
            return Ok(());
        }
        let expected = format!("an index below {objects}, the number of objects");
        Err(Error::invalid_input("object", object, &expected))
    }

    /// Advances the world by a number of ticks.
    pub(super) fn run(&mut self, ticks: u64) {
        let end = self.tick + ticks;
        while self.tick < end {
            self.make_moves();
            let ahead = self.ahead().min(end - self.tick) as usize;
            let (mut drifts, robots) = (std::mem::take(&mut self.drifts), self.bodies.len());
            drifts.resize(ahead * robots, Drift::default());
            self.run_drives(ahead, &mut drifts);
            for tick in 0..ahead {
                self.step(&mut drifts[tick * robots..][..robots]);
            }
            self.drifts = drifts;
        }
    }

    /// Ticks for which the drives may run ahead of the robots: until then nobody looks at them, and nothing
    /// that stops a robot changes what its drive does.
    fn ahead(&self) -> u64 {
        if self.watcher.is_some() || self.hills.is_some() || !self.independent {
            return 1;
        }
        let trail = self.trail_ticks.map_or(u64::MAX, |ticks| ticks - self.tick % ticks);
        trail.min(AHEAD as u64)
    }

    /// Lets all drives run for some ticks. A drive's state is brought into the cache only once.
    fn run_drives(&mut self, ticks: usize, drifts: &mut [Drift]) {
        let robots = self.bodies.len();
        let mut own = [Drift::default(); AHEAD];
        for (index, (machine, body)) in self.machines.iter_mut().zip(&self.bodies).enumerate() {
            machine.drive.run(&mut own[..ticks]);
            for (tick, drift) in own[..ticks].iter().enumerate() {
                drifts[tick * robots + index] = Drift { reach: body.reach(drift.motion), ..*drift };
            }
        }
    }

    /// Advances the world by one tick, in which the drives have done this.
    fn step(&mut self, drifts: &mut [Drift]) {
        if let Some(hills) = &mut self.hills {
            let time = self.tick as f64 / TICKS_PER_SECOND;
            hills.ride(&mut self.bodies, &mut self.machines, drifts, time);
        }
        self.move_bodies(drifts);
        if let Some(hills) = &mut self.hills {
            hills.yield_to(&mut self.bodies, &self.machines, &mut self.space);
            hills.measure(&mut self.machines);
            self.slide_things();
        }
        self.feel();
        self.radio.deliver(&mut self.machines);
        self.tick += 1;
        self.extend_trails();
        self.show();
    }

    /// Restarts the inertial unit of a robot that was placed elsewhere.
    pub(super) fn begin_inertial(&mut self, index: usize) {
        let body = &self.bodies[index];
        if let Some(unit) = &mut self.machines[index].inertial {
            let (pose, elevation) = (body.course.pose(), body.span.bottom);
            unit.begin(pose_in_space(self.hills.as_deref(), index, pose, elevation));
        }
    }

    /// Updates inertial units with the robots' motion in this tick.
    fn feel(&mut self) {
        for (index, (body, machine)) in self.bodies.iter().zip(&mut self.machines).enumerate() {
            if let Some(unit) = &mut machine.inertial {
                let (pose, elevation) = (body.course.pose(), body.span.bottom);
                unit.feel(pose_in_space(self.hills.as_deref(), index, pose, elevation));
            }
        }
    }

    fn extend_trails(&mut self) {
        if self.trail_ticks.is_some_and(|ticks| self.tick.is_multiple_of(ticks)) {
            let time = self.time();
            for (body, machine) in self.bodies.iter().zip(&mut self.machines) {
                let odometry = machine.drive.get().odometry();
                machine.trail.push(TrailPoint { time, pose: body.pose(), odometry });
            }
        }
    }

    pub(super) fn set_twist(&mut self, index: usize, twist: Twist) -> Result<()> {
        for (name, speed) in [("linear speed", twist.linear), ("angular speed", twist.angular)] {
            if speed.is_nan() || speed.abs() > units::FARTHEST {
                return Err(Error::invalid_input(name, speed, "a finite number of at most 1e6 either way"));
            }
        }
        let drive = self.machines[index].drive.get_mut();
        drive.begin_command();
        drive.set_twist(twist);
        Ok(())
    }

    pub(super) fn manoeuvre(&mut self, index: usize, motion: Displacement, speed: f64) -> Result<()> {
        require_finite("distance", motion.length)?;
        require_finite("angle", motion.angle)?;
        require_positive("speed", speed.abs())?;
        let machine = &mut self.machines[index];
        let seconds = machine.drive.get().least_seconds(motion, speed)?;
        if seconds.is_nan() || seconds > LONGEST {
            let found = format!("{seconds} s long");
            return Err(Error::invalid_input("manoeuvre", found, &format!("at most {LONGEST} s")));
        }
        machine.drive.get_mut().begin_command();
        // A waiting program must not see the previous manoeuvre's stall.
        self.bodies[index].touch.held_ticks = 0;
        machine.drive.get_mut().start(motion, speed);
        Ok(())
    }

    pub(super) fn set_motor(&mut self, index: usize, motor: u8, fraction: f64) -> Result<()> {
        let machine = &mut self.machines[index];
        let motor = machine.motor_index(motor)?;
        if !(-1.0..=1.0).contains(&fraction) {
            return Err(Error::invalid_input("motor speed", fraction, "-1 to 1"));
        }
        machine.drive.get_mut().begin_command();
        machine.drive.get_mut().set_motor(motor, fraction);
        Ok(())
    }

    pub(super) fn set_servo(&mut self, index: usize, servo: u8, position: f64) -> Result<()> {
        let machine = &mut self.machines[index];
        let own = machine.drive.get().servos();
        match (&mut machine.camera, servo.checked_sub(own)) {
            // The head's two servos follow those of the drive.
            (Some(camera), Some(head @ 1..=2)) => camera.set_servo(head, position, self.tick),
            _ => machine.drive.get_mut().set_servo(servo, position),
        }
    }

    /// Camera of a robot that has one.
    fn camera(&mut self, index: usize) -> Result<&mut CameraDevice> {
        self.machines[index].camera.as_deref_mut().ok_or_else(|| Error::unsupported("camera"))
    }

    pub(super) fn resolution(&mut self, index: usize) -> Result<Resolution> {
        Ok(self.camera(index)?.resolution)
    }

    pub(super) fn set_resolution(&mut self, index: usize, resolution: Resolution) -> Result<()> {
        self.camera(index)?.resolution = resolution;
        Ok(())
    }

    pub(super) fn image_into(&mut self, index: usize, image: &mut RgbImage) -> Result<()> {
        let pose = self.bodies[index].pose();
        let Some(camera) = &mut self.machines[index].camera else { return Err(Error::unsupported("camera")) };
        let moment = Moment { tick: self.tick, light: self.options.light, noise: &self.options.noise };
        let around = (&self.space, self.hills.as_deref());
        camera.take(&mut self.studio, around, (index, pose), moment, image)?;
        if let Some(watcher) = &mut self.watcher {
            watcher.image(index, image);
        }
        Ok(())
    }

    pub(super) fn depth(&mut self, index: usize) -> Result<f64> {
        let (time, sigma) = (self.time(), self.options.noise.depth);
        let Some(gauge) = &mut self.machines[index].depth else {
            return Err(Error::unsupported("depth sensor"));
        };
        let depth = self.hills.as_ref().map_or(0.0, |hills| hills.depth(index, gauge.spec.z, time));
        Ok(gauge.read(depth, sigma))
    }

    fn inertial(&mut self, index: usize) -> Result<&mut InertialUnit> {
        self.machines[index].inertial.as_deref_mut().ok_or_else(|| Error::unsupported("inertial unit"))
    }

    pub(super) fn attitude(&mut self, index: usize) -> Result<Attitude> {
        let (tick, noise) = (self.tick, self.options.noise);
        self.inertial(index)?.attitude(tick, &noise)
    }

    pub(super) fn turn_rates(&mut self, index: usize) -> Result<Vector3> {
        let (tick, noise) = (self.tick, self.options.noise);
        self.inertial(index)?.turn_rates(tick, &noise)
    }

    pub(super) fn acceleration(&mut self, index: usize) -> Result<Vector3> {
        let (tick, noise) = (self.tick, self.options.noise);
        self.inertial(index)?.acceleration(tick, &noise)
    }

    pub(super) fn set_odometry(&mut self, index: usize, pose: Pose) -> Result<()> {
        if !pose.is_finite() {
            return Err(Error::invalid_input("pose", pose_in_words(&pose), "finite numbers"));
        }
        self.machines[index].drive.get_mut().set_odometry(pose);
        Ok(())
    }

    pub(super) fn psd(&mut self, index: usize, psd: Psd) -> Result<f64> {
        let sigma = self.options.noise.range;
        let (body, machine) = (&self.bodies[index], &mut self.machines[index]);
        let device = machine.psd(psd)?;
        let (place, ahead, max_range) = (device.place, device.direction, device.max_range);
        let range = if device.level && self.hills.is_none() {
            let origin = body.pose().position() + body.course.turned(place.xy().coords);
            let (direction, height) = (body.course.turned(ahead.xy()), body.span.bottom + place.z);
            self.space.cast_ray(origin, direction, height, max_range, Some(body.solid))
        } else {
            let pose = pose_in_space(self.hills.as_deref(), index, body.pose(), body.span.bottom);
            let (origin, direction) = (pose.to_world(place), pose.rotate(ahead));
            let ground = self.hills.as_deref().map(Hills::ground);
            self.space.cast_ray_over(ground, origin, direction, max_range, Some(body.solid))
        };
        let reading = noisy(range, sigma, max_range, &mut machine.psd_noise);
        if let Some(watcher) = &mut self.watcher {
            watcher.distance(index, psd, reading);
        }
        Ok(reading)
    }

    pub(super) fn scan_into(&mut self, index: usize, scan: &mut LidarScan) -> Result<()> {
        let sigma = self.options.noise.range;
        let body = &self.bodies[index];
        let Some(device) = &mut self.machines[index].lidar else { return Err(Error::unsupported("lidar")) };
        let (angle_min, angle_increment) = device.settings.beams();
        scan.angle_min = angle_min;
        scan.angle_increment = angle_increment;
        scan.range_max = device.max_range;
        scan.mount = device.mount;
        scan.ranges.resize(device.settings.points, f64::INFINITY);
        if device.level && self.hills.is_none() {
            let pose = body.course.mounted(&device.mount);
            self.space.scan(&mut device.scanner, &pose, Some(body.solid), &mut scan.ranges);
        } else {
            let robot = pose_in_space(self.hills.as_deref(), index, body.course.pose(), body.span.bottom);
            let (ground, pose) = (self.hills.as_deref().map(Hills::ground), robot.compose(&device.frame));
            self.space.scan_over(ground, &device.scanner, &pose, Some(body.solid), &mut scan.ranges);
        }
        make_noisy(&mut scan.ranges, sigma, device.max_range, &mut device.noise);
        if let Some(watcher) = &mut self.watcher {
            watcher.scan(index, scan);
        }
        Ok(())
    }

    pub(super) fn configure_lidar(&mut self, index: usize, settings: LidarSettings) -> Result<()> {
        match &mut self.machines[index].lidar {
            Some(device) => device.configure(settings),
            None => Err(Error::unsupported("lidar")),
        }
    }

    pub(super) fn send(&mut self, index: usize, to: u32, data: &[u8]) -> Result<()> {
        self.radio.send(index, to, data, self.bodies.len())
    }
}

/// Pose of a robot in space: from the hills, or level above the floor.
fn pose_in_space(hills: Option<&Hills>, robot: usize, pose: Pose, elevation: f64) -> Pose3 {
    match hills {
        Some(hills) => hills.pose(robot),
        None => Pose3::level(pose, elevation),
    }
}

/// Fails unless walls and objects are finite, and walls have a height: others are in maps, and stop nobody.
fn check_world(world: &World) -> Result<()> {
    for (index, wall) in world.walls.iter().enumerate() {
        let numbers =
            [wall.line.a.x, wall.line.a.y, wall.line.b.x, wall.line.b.y, wall.thickness, wall.height];
        if !(numbers.into_iter().all(f64::is_finite) && wall.height > 0.0) {
            let (from, to) = (point_in_words(wall.line.a), point_in_words(wall.line.b));
            let found = format!("from {from} to {to}, {} m thick, {} m high", wall.thickness, wall.height);
            return Err(Error::invalid_input(&format!("wall {index}"), found, "finite, with a height"));
        }
    }
    for (index, object) in world.objects.iter().enumerate() {
        let shape = &object.kind.shape;
        let numbers = [object.elevation, shape.bounding_radius(), shape.height()];
        if !(object.pose.is_finite() && numbers.into_iter().all(f64::is_finite)) {
            let name = format!("object {index}, {},", object.kind.name);
            let [elevation, radius, height] = numbers;
            let found = format!(
                "at {}, {elevation} m above the floor, {radius} m in radius, {height} m high",
                pose_in_words(&object.pose)
            );
            return Err(Error::invalid_input(&name, found, "finite numbers"));
        }
    }
    Ok(())
}

fn check_placement(placement: &RobotPlacement) -> Result<()> {
    let described = placement.spec.validate();
    described.map_err(|e| Error::new(ErrorKind::InvalidInput, e.to_string()).with_source(e))?;
    if placement.pose.is_finite() && placement.elevation.is_finite() {
        return Ok(());
    }
    let found = format!("{}, {} m above the floor", pose_in_words(&placement.pose), placement.elevation);
    Err(Error::invalid_input("robot pose", found, "finite numbers"))
}
