//! EyeSim's robots (`.robi`).
//!
//! | line | meaning |
//! |---|---|
//! | `drive AUV_DRIVE`, `BOAT_DRIVE` | a craft in water, underwater or on the surface: names of our own |
//! | `drive DIFFERENTIAL_DRIVE`, `ACKERMANN_DRIVE`, `OMNI_DRIVE`, `TRACKED_DRIVE` | how it moves; `TRACK_DRIVE` and `CHAIN_DRIVE` are tracked too; other names are read as differential with a `wheel` line, as `AUV_DRIVE` without one |
//! | `name NAME` | name for scenes; default: the name of the file |
//! | `model FILE [X Y Z RX RY RZ]` | 3D model for cameras, with its offset and rotation |
//! | `collider box SX SY SZ X Y Z`, `sphere R X Y Z`, `capsule R H X Y Z` | solid parts: sizes, then centre |
//! | `mass KG X Y Z` | mass and its centre, which is used on hills unless it is 0 0 0 |
//! | `axis UP FORWARD` | the driven axle |
//! | `axel drive UP FORWARD`, `axel turn UP FORWARD` | the driven and the steered axle |
//! | `wheel [drive\|turn] DIAMETER DEG_PER_S TICKS HALF_TRACK` | the wheels |
//! | `psd ID NAME X Y Z R1 R2 R3`, `psd NAME ID X Y Z R`, `psd NAME ID X Y Z R1 R2 R3` | a distance sensor |
//! | `camera X Y Z PAN TILT MAX_PAN MAX_TILT` | the camera |
//! | `fisheye DEG` | equidistant lens with this horizontal field of view |
//! | `lidar [X Y Z R1 R2 R3] RANGE TILT POINTS`, `lidar RANGE POINTS TILT`, `lidar POINTS TILT` | the scanner |
//!
//! The model's axes point right, up and forwards. Sensors and footprint of a
//! [`RobotSpec`](crate::world::RobotSpec) are relative to the middle of the driven axle, whose position in
//! the model is [`Body::axle`](crate::world::Body::axle); heights are those of the model. The footprint
//! follows from the colliders by the rule of [`Body::footprint`](crate::world::Body::footprint); without
//! colliders it is a disc that extends a wheel's radius beyond the wheels.
//!
//! # Poses of sensors
//!
//! Existing files disagree about the columns of `psd`, `lidar` and `camera`. This reader interprets them as
//! follows.
//!
//! * `psd NAME ID X Y Z` and one or three rotations: forward, left, up; a single rotation is to the left.
//! * `psd ID NAME X Y Z R1 R2 R3`: R1 turns the sensor down; 90 is straight down. One of R2 and R3 turns it
//!   sideways; the other one would rotate a single ray about itself and is 0 in all existing files. If any
//!   sensor of the file is turned sideways by R3, the columns are side, forward, up, and turns are clockwise;
//!   otherwise they are forward, left, up, and turns are to the left. Without any such turn, a sensor called
//!   FRONT with X = 0 implies the former columns.
//! * A name that indicates left (LEFT, or L among the letters F, B, R, L as in `PSD_FL`) makes side and yaw
//!   left; one that indicates right makes them right.
//! * `lidar` with nine numbers has the columns of the file's `psd` lines that begin with a number; without
//!   such lines, forward, left, up. All three rotations turn its plane: down in front, sideways, and about
//!   the forward axis, which raises its left side with the columns forward, left, up, and its right side
//!   otherwise. The order is roll, pitch, yaw. The tilt is the angle of each beam above that plane.
//! * `camera`: forward, left, up, unless X is 0 and Y is not; then Y is forward.
//!
//! # Craft without lines of their own
//!
//! Missing properties of a craft follow from its mass and its colliders. The colliders are the hull, scaled
//! so that an underwater craft has a reserve of buoyancy of 5 % and a boat floats at least half out of the
//! water; inertia, added mass and damping are those of
//! [`CraftSpec::of_hull`](crate::kinematics::marine::CraftSpec::of_hull); an underwater craft has four
//! thrusters as Mako has them (1 left, 2 front, 3 right, 4 back), a boat two at its stern (1 left, 2 right),
//! each with a force of 0.7 N/kg.
//!
//! Odometry, such as `VWGetPosition`, is dead reckoning: the way through the water, along the heading from
//! the turn rate. A current therefore does not show in it, unless the craft has a Doppler log (`dvl`) that
//! sees the ground.
//!
//! # Lines of our own
//!
//! EyeSim skips unknown keywords, so a description can contain data here that EyeSim's formats cannot
//! express:
//!
//! | line | meaning |
//! |---|---|
//! | `motor LAG ACCELERATION` | seconds, and millimetres per second squared |
//! | `steering DEG` | largest steering angle; default 30 |
//! | `dynamics MASS GYRATION GRIP STIFFNESS BALANCE BRAKE STEERING` | a fast car's mass and tyres: [`CarDynamics`](crate::world::CarDynamics), in millimetres, their products with 1/s², and degrees per second |
//! | `tracks LENGTH WIDTH` | a tracked robot's belts: their length on the ground, and their width |
//! | `thruster ID NAME X Y Z DX DY DZ FORCE [BACK]` | a craft's thruster: place, direction (both forward, left, up), newtons forward and backward; BACK is 0.7 of FORCE without it |
//! | `hull box SX SY SZ X Y Z`, `hull capsule R LENGTH X Y Z [x\|y\|z]`, `hull ellipsoid A B C X Y Z` | what displaces water: sizes (or half axes), then middle, forward, left, up |
//! | `damping` and 12 numbers | a craft's linear damping in surge, sway, heave, roll, pitch, yaw, then its quadratic damping: N s/m and so on |
//! | `added_mass` and 6 numbers | kg and kg m² |
//! | `inertia IXX IYY IZZ IXY IXZ IYZ` | a craft's inertia about the middle of its mass, in kg m² |
//! | `friction MU` | the coefficient of friction on hills; 0.8 without it |
//! | `outline disc R HEIGHT`, `outline rectangle BACK RIGHT FRONT LEFT HEIGHT` | footprint about the driven axle |
//! | `mast BACK RIGHT FRONT LEFT HEIGHT` | a narrow part above the rest, for rays |
//! | `psd_range MM` | range of the preceding `psd` |
//! | `lidar_range MM` | range of the lidar |
//! | `depth_sensor CHANNEL [Z]` | a depth sensor: its channel of `ANALOGRead`, and its height |
//! | `dvl RANGE` | a craft's Doppler log, which sees the ground so far below: odometry is the way over ground |
//! | `inertial` and 3, 6 or 9 channels | an inertial unit: channels of `ANALOGRead` for roll, pitch and yaw, turn rates, and accelerations, in the order forward, left, up: [`InertialSpec`](crate::world::InertialSpec); 0 0 0 for missing measurements |
//! | `compass` | the inertial unit has a compass, so that its yaw does not drift |
//! | `camera_view DEG` | the camera's horizontal field of view |
//!
//! ```
//! use roverlab::world::formats::robi;
//! let text = "drive DIFFERENTIAL_DRIVE\nname Tiny\nwheel 54 3600 1100 45\npsd 1 FRONT 50 0 20 0 0 0\n";
//! let spec = robi::parse(text, "tiny.robi")?.value;
//! assert_eq!((spec.name.as_str(), spec.psds.len()), ("Tiny", 1));
//! assert_eq!(robi::parse(&robi::print(&spec), "tiny.robi")?.value, spec);
//! # Ok::<(), roverlab::world::formats::FormatError>(())
//! ```

mod craft;
mod mounts;
mod parts;
mod read;
#[cfg(test)]
mod tests;
mod write;

pub use read::parse;
pub(super) use read::parse_with_model;
pub use write::print;
