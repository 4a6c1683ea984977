use super::body::{Body, TrailPoint, push_out, ray};
use super::{SimOptions, TICK};
use crate::geometry::{Aabb, Point, Pose, Twist, Vector};
use crate::io::error::{require_finite, require_positive};
use crate::io::{Error, LidarScan, LidarSettings, Psd, RadioMessage, Result};
use crate::kinematics::{Displacement, advance};
use crate::random::Stream;
use crate::world::space::{Contact, Outline, Solid, Space};
use crate::world::{Footprint, Object, Scene, Shape};

/// A world and its robots at one instant, and how they get to the next.
#[derive(Debug)]
pub(super) struct Engine {
    pub(super) space: Space,
    pub(super) bodies: Vec<Body>,
    pub(super) options: SimOptions,
    /// Ticks since the start.
    pub(super) tick: u64,
    motions: Vec<Displacement>,
    contacts: Vec<Contact>,
    outbox: Vec<Letter>,
}

/// A radio message under way.
#[derive(Debug)]
struct Letter {
    from: u32,
    to: u32,
    data: Vec<u8>,
}

/// How far a look for obstacles reaches, in metres: a longer one costs more and comes less often.
const LOOK_AHEAD: f64 = 0.25;
/// A robot that is this near to something still touches it.
const TOUCH_MARGIN: f64 = 5e-4;
/// Attempts to push a robot out of what it ran into before it stays where it was.
const PUSH_ATTEMPTS: usize = 4;
/// The largest depth, in metres, that counts as pushed out.
const PUSH_TOLERANCE: f64 = 1e-6;
/// The longest radio message in bytes.
const MAX_MESSAGE: usize = 65_536;
/// Messages that may wait for one robot; the oldest are lost beyond it.
const MAX_MAILBOX: usize = 10_000;

impl Engine {
    pub(super) fn new(scene: &Scene, options: SimOptions) -> Result<Self> {
        options.validate()?;
        let mut space = Space::new(&scene.world.walls);
        for object in &scene.world.objects {
            space.add(solid_of(object));
        }
        let root = Stream::new(options.seed);
        let mut bodies = Vec::with_capacity(scene.robots.len());
        for (index, placement) in scene.robots.iter().enumerate() {
            placement
                .spec
                .validate()
                .map_err(|e| Error::new(crate::io::ErrorKind::InvalidInput, e.to_string()).with_source(e))?;
            if !placement.pose.is_finite() || !placement.elevation.is_finite() {
                let found = format!("{:?}", placement.pose);
                return Err(Error::invalid_input("robot pose", found, "finite numbers"));
            }
            let solid = space.add(Body::as_solid(placement));
            bodies.push(Body::new(placement, solid, &options, &root.child("robot", index as u64))?);
        }
        let motions = vec![Displacement::default(); bodies.len()];
        Ok(Self { space, bodies, options, tick: 0, motions, contacts: Vec::new(), outbox: Vec::new() })
    }

    /// Seconds since the start, at the present tick.
    pub(super) fn time(&self) -> f64 {
        self.tick as f64 * TICK
    }

    /// Advances the world by one tick.
    pub(super) fn step(&mut self) {
        let mut farthest: f64 = 0.0;
        let mut moving = false;
        for (body, motion) in self.bodies.iter_mut().zip(&mut self.motions) {
            let command = body.autopilot.command(&body.drivetrain);
            *motion = body.drivetrain.step(command);
            farthest = farthest.max(reach(body, *motion));
            moving |= *motion != Displacement::default();
        }
        if moving {
            for index in 0..self.bodies.len() {
                self.move_body(index, farthest);
            }
        }
        self.deliver();
        self.tick += 1;
        self.extend_trails();
    }

    fn extend_trails(&mut self) {
        let Some(interval) = self.options.trail_interval else { return };
        let ticks = (interval / TICK).round() as u64;
        if self.tick.is_multiple_of(ticks) {
            let time = self.time();
            for body in &mut self.bodies {
                let odometry = body.drivetrain.odometry();
                body.trail.push(TrailPoint { time, pose: body.pose, odometry });
            }
        }
    }

    /// Moves a robot by its motion of this tick; no other robot moves more than `farthest`.
    fn move_body(&mut self, index: usize, farthest: f64) {
        let motion = self.motions[index];
        let body = &mut self.bodies[index];
        body.solid_budget -= farthest;
        if motion == Displacement::default() {
            body.touch.held_ticks = 0;
            return;
        }
        let reach = reach(body, motion);
        body.wall_budget -= reach;
        body.solid_budget -= reach;
        let before = body.pose;
        let wished = advance(before, motion);
        let near = body.wall_budget <= 0.0 || body.solid_budget <= 0.0;
        body.pose = wished;
        if near {
            self.collide(index, before);
        }
        let body = &mut self.bodies[index];
        self.space.set_pose(body.solid, body.pose);
        let moved = (body.pose.position() - before.position()).norm();
        body.note_motion(motion.length.abs(), moved);
    }

    /// Frees a robot from what its wish ran into, and renews its budgets.
    fn collide(&mut self, index: usize, before: Pose) {
        let body = &mut self.bodies[index];
        let (outline, span, me) = (body.outline, body.span, Some(body.solid));
        let walls = self.space.walls_clearance(&outline, &body.pose, span, LOOK_AHEAD);
        let solids = self.space.solids_clearance(&outline, &body.pose, span, LOOK_AHEAD, me);
        body.wall_budget = walls;
        body.solid_budget = solids;
        if walls > TOUCH_MARGIN && solids > TOUCH_MARGIN {
            body.touch.touching = false;
            return;
        }
        let mut pose = body.pose;
        let mut freed = false;
        for _ in 0..PUSH_ATTEMPTS {
            self.space.contacts(&outline, &pose, span, me, &mut self.contacts);
            let deepest = self.contacts.iter().map(|c| c.depth).fold(0.0, f64::max);
            if deepest <= PUSH_TOLERANCE {
                freed = true;
                break;
            }
            self.note_touch(index, pose);
            let push = push_out(&self.contacts);
            pose.x += push.x;
            pose.y += push.y;
        }
        let body = &mut self.bodies[index];
        body.pose = if freed { pose } else { stay(&body.spec.footprint, before, body.pose) };
    }

    /// Puts a robot somewhere else, and lets every robot look around again.
    pub(super) fn place(&mut self, index: usize, pose: Pose) {
        let body = &mut self.bodies[index];
        body.pose = pose;
        body.wall_budget = 0.0;
        self.space.set_pose(body.solid, pose);
        for body in &mut self.bodies {
            body.solid_budget = 0.0;
        }
    }

    /// Counts a contact for a robot and for the robots that it touches.
    fn note_touch(&mut self, index: usize, pose: Pose) {
        let normal = self.contacts.first().map_or_else(Vector::zeros, |c| c.normal);
        let body = &mut self.bodies[index];
        let place = pose.position() - normal * body.spec.footprint.bounding_radius();
        body.touch.begin(place);
        for contact in &self.contacts {
            if let Some(other) = self.bodies.iter_mut().find(|b| Some(b.solid) == contact.with) {
                other.touch.begin(place);
                other.solid_budget = 0.0;
            }
        }
    }

    /// Puts the letters of this tick into mailboxes, in an order that no scheduling changes.
    fn deliver(&mut self) {
        if self.outbox.is_empty() {
            return;
        }
        self.outbox.sort_by_key(|letter| letter.from);
        for letter in self.outbox.drain(..) {
            let mailbox = &mut self.bodies[letter.to as usize - 1].mailbox;
            if mailbox.len() == MAX_MAILBOX {
                mailbox.pop_front();
            }
            mailbox.push_back(RadioMessage { from: letter.from, data: letter.data });
        }
    }

    pub(super) fn set_twist(&mut self, index: usize, twist: Twist) -> Result<()> {
        require_finite("linear speed", twist.linear)?;
        require_finite("angular speed", twist.angular)?;
        let body = &mut self.bodies[index];
        body.drivetrain.begin_command();
        body.autopilot.set_twist(&body.drivetrain, twist);
        Ok(())
    }

    pub(super) fn manoeuvre(&mut self, index: usize, motion: Displacement, speed: f64) -> Result<()> {
        require_finite("distance", motion.length)?;
        require_finite("angle", motion.angle)?;
        require_positive("speed", speed.abs())?;
        let body = &mut self.bodies[index];
        body.drivetrain.begin_command();
        body.autopilot.start(&body.drivetrain, motion, speed);
        Ok(())
    }

    pub(super) fn set_motor(&mut self, index: usize, motor: u8, fraction: f64) -> Result<()> {
        let wheel = super::body::wheel_index(motor, "motor")?;
        if !(-1.0..=1.0).contains(&fraction) {
            return Err(Error::invalid_input("motor speed", fraction, "-1 to 1"));
        }
        let body = &mut self.bodies[index];
        body.autopilot.set_motor(&body.drivetrain, wheel, fraction);
        Ok(())
    }

    pub(super) fn psd(&mut self, index: usize, psd: Psd) -> Result<f64> {
        let sigma = self.options.noise.range;
        let body = &mut self.bodies[index];
        let (mount, max_range) = body.psd(psd)?;
        let (origin, direction) = ray(&body.device_pose(&mount));
        let z = body.device_height(mount.z);
        let range = self.space.cast_ray(origin, direction, z, max_range, Some(body.solid));
        Ok(noisy(range, sigma, max_range, &mut body.psd_noise))
    }

    pub(super) fn scan_into(&mut self, index: usize, scan: &mut LidarScan) -> Result<()> {
        let sigma = self.options.noise.range;
        let body = &mut self.bodies[index];
        let Some(device) = &body.lidar else { return Err(Error::unsupported("lidar")) };
        let pose = body.device_pose(&device.mount);
        let device = body.lidar.as_mut().expect("checked above");
        let (angle_min, angle_increment) = device.settings.beams();
        scan.angle_min = angle_min;
        scan.angle_increment = angle_increment;
        scan.range_max = device.max_range;
        scan.mount = Pose::new(device.mount.x, device.mount.y, device.mount.yaw);
        scan.ranges.resize(device.settings.points, f64::INFINITY);
        self.space.scan(&mut device.scanner, &pose, Some(body.solid), &mut scan.ranges);
        if sigma > 0.0 {
            for range in &mut scan.ranges {
                *range = noisy(*range, sigma, device.max_range, &mut device.noise);
            }
        }
        Ok(())
    }

    pub(super) fn configure_lidar(&mut self, index: usize, settings: LidarSettings) -> Result<()> {
        match &mut self.bodies[index].lidar {
            Some(device) => device.configure(settings),
            None => Err(Error::unsupported("lidar")),
        }
    }

    pub(super) fn send(&mut self, index: usize, to: u32, data: &[u8]) -> Result<()> {
        if to == 0 || to as usize > self.bodies.len() {
            let expected = format!("1 to {}", self.bodies.len());
            return Err(Error::invalid_input("radio receiver", to, &expected));
        }
        if data.len() > MAX_MESSAGE {
            return Err(Error::invalid_input("radio message length", data.len(), "at most 65536 bytes"));
        }
        self.outbox.push(Letter { from: index as u32 + 1, to, data: data.to_vec() });
        Ok(())
    }
}

/// An object as robots meet it.
fn solid_of(object: &Object) -> Solid {
    let outline = match object.kind.shape {
        Shape::Cylinder { radius, .. } | Shape::Sphere { radius } => Outline::Disc { radius },
        Shape::Box { length, width, .. } => {
            let corner = Point::new(0.5 * length, 0.5 * width);
            Outline::Rectangle(Aabb::new(-corner, corner))
        }
    };
    let bottom = object.elevation;
    Solid { outline, pose: object.pose, bottom, top: bottom + object.kind.shape.height() }
}

/// No point of the robot's outline moves farther than this.
fn reach(body: &Body, motion: Displacement) -> f64 {
    let spin = match body.spec.footprint {
        Footprint::Disc { .. } => 0.0,
        Footprint::Rectangle(_) => body.spec.footprint.bounding_radius(),
    };
    motion.length.abs() + spin * motion.angle.abs()
}

/// Where a robot stays that cannot be freed: a disc still turns on its spot.
fn stay(footprint: &Footprint, before: Pose, wished: Pose) -> Pose {
    match footprint {
        Footprint::Disc { .. } => Pose { heading: wished.heading, ..before },
        Footprint::Rectangle(_) => before,
    }
}

/// A reading with its noise; no return stays no return.
fn noisy(range: f64, sigma: f64, max_range: f64, stream: &mut Stream) -> f64 {
    if sigma == 0.0 || range.is_infinite() {
        return range;
    }
    let reading = (range + sigma * stream.normal()).max(0.0);
    if reading > max_range { f64::INFINITY } else { reading }
}
