mod finish;

use std::path::PathBuf;
use std::sync::Arc;

use super::super::args::Args;
use super::super::error::{FormatError, Location, Notes, Parsed};
use super::super::esobj::DEFAULT_COLOUR;
use super::super::lexer::{self, Line, shown};
use super::super::limits::MAX_PARTS;
use super::super::model;
use super::super::source::{Files, check_length};
use super::craft::CraftLines;
use super::mounts::{self, Raw};
use super::parts::{self, Wheel};
use crate::geometry::{math, units};
use crate::world::formats::stem;
use crate::world::{
    Body, CameraSpec, CarDynamics, DepthSensorSpec, Footprint, InertialSpec, LidarSpec, Mast, Mesh, Mount,
    PsdSpec, RobotSpec,
};

/// Default steering limit of cars (rad): 30 degrees.
pub(super) const DEFAULT_STEERING: f64 = std::f64::consts::FRAC_PI_6;
/// Height of robots without colliders (m).
const DEFAULT_HEIGHT: f64 = 0.1;

/// Reads a robot without its 3D model; [`load_robot`](crate::world::formats::load_robot) and scripts also
/// read the model. A `drive` line is required.
pub fn parse(text: &str, file: &str) -> Result<Parsed<RobotSpec>, FormatError> {
    let (mut parsed, model_at) = read(text, file)?;
    let mut notes = Notes::new(file);
    if let Some(at) = model_at {
        notes.warn(at, "`model`: cameras see the robot's outline instead");
    }
    parsed.warnings.extend(notes.finish(()).warnings);
    Ok(parsed)
}

/// Reads a robot and its 3D model.
pub(in crate::world::formats) fn parse_with_model(
    text: &str,
    file: &str,
    files: &mut Files<'_>,
) -> Result<Parsed<RobotSpec>, FormatError> {
    let (Parsed { value: mut spec, warnings }, model_at) = read(text, file)?;
    let mut notes = Notes::new(file);
    notes.extend(warnings);
    if let (Some(model), Some(at)) = (&spec.model, model_at) {
        let mesh = model::load(model, (file, at), (1.0, DEFAULT_COLOUR), files, &mut notes)?;
        spec.mesh = mesh.map(|mesh| Arc::new(placed(Arc::unwrap_or_clone(mesh), &spec.body)));
    }
    Ok(notes.finish(spec))
}

/// A model at its pose on the robot, relative to the middle of the driven axle. As in EyeSim, it is rotated
/// in sequence about its forward, right and up axes; positive turns are to the left, downwards and to the
/// right.
fn placed(mut mesh: Mesh, body: &Body) -> Mesh {
    let [right, up, ahead] = body.model_offset;
    let [(sin_x, cos_x), (sin_y, cos_y), (sin_z, cos_z)] = body.model_rotation.map(math::sin_cos);
    for corner in mesh.faces.iter_mut().flat_map(|face| &mut face.corners) {
        let [z, left, y] = *corner;
        let (x, y) = (-left * cos_z - y * sin_z, -left * sin_z + y * cos_z);
        let (y, z) = (y * cos_x - z * sin_x, y * sin_x + z * cos_x);
        let (x, z) = (x * cos_y + z * sin_y, z * cos_y - x * sin_y);
        *corner = [z + ahead - body.axle[0], -(x + right), y + up];
    }
    mesh
}

/// Reads a robot; also returns the location of its model's name.
fn read(text: &str, file: &str) -> Result<(Parsed<RobotSpec>, Option<Location>), FormatError> {
    check_length(text, file)?;
    let mut reader = Reader::new(file);
    for (number, text) in lexer::numbered(text) {
        if let Some(line) = lexer::line(file, number, text)? {
            reader.line(&line)?;
        }
    }
    let model_at = reader.model_at;
    Ok((reader.finish()?, model_at))
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Drive {
    Differential,
    Ackermann,
    Tracked,
    Omni,
    Submarine,
    Boat,
    /// One of another name.
    Unknown,
}

/// A `psd` line.
struct Psd {
    id: u8,
    name: String,
    raw: Raw,
    /// Whether its columns are those of the file instead of being fixed by its form.
    shared: bool,
    max_range: f64,
}

struct Reader<'f> {
    spec: RobotSpec,
    drive: Option<Drive>,
    wheel: Option<Wheel>,
    turn_axle: Option<f64>,
    /// Length and width of the belts.
    tracks: Option<[f64; 2]>,
    steering: f64,
    craft: CraftLines,
    dynamics: Option<CarDynamics>,
    psds: Vec<Psd>,
    lidar_mount: Option<Raw>,
    lidar_range: Option<f64>,
    camera_place: Option<[f64; 3]>,
    camera_view: Option<(f64, bool)>,
    outline: Option<(Footprint, f64)>,
    mast: Option<(Mast, Location)>,
    model_at: Option<Location>,
    notes: Notes<'f>,
}

impl<'f> Reader<'f> {
    fn new(file: &'f str) -> Self {
        let blank = RobotSpec {
            name: stem(file),
            mass: 1.0,
            psds: Vec::new(),
            lidar: None,
            camera: None,
            depth_sensor: None,
            dvl: None,
            inertial: InertialSpec::default(),
            compass: false,
            mast: None,
            ..RobotSpec::s4()
        };
        Self {
            spec: blank,
            drive: None,
            wheel: None,
            turn_axle: None,
            tracks: None,
            steering: DEFAULT_STEERING,
            craft: CraftLines::default(),
            dynamics: None,
            psds: Vec::new(),
            lidar_mount: None,
            lidar_range: None,
            camera_place: None,
            camera_view: None,
            outline: None,
            mast: None,
            model_at: None,
            notes: Notes::new(file),
        }
    }

    fn line(&mut self, line: &Line<'_>) -> Result<(), FormatError> {
        let keyword = line.words[0].text.to_ascii_lowercase();
        let mut args = Args::after_keyword(line);
        if self.drive.is_none() && keyword != "drive" {
            self.notes.warn(line.location(0), "a line before `drive`, which EyeSim wants first");
        }
        match keyword.as_str() {
            "drive" => return self.drive(line, &mut args),
            "name" => self.spec.name = args.name("a name")?,
            "model" => {
                self.model(&mut args)?;
                self.model_at = Some(line.location(1));
            }
            "collider" => {
                check_parts(line, self.spec.body.colliders.len())?;
                let collider = parts::collider(line, &mut args)?;
                self.spec.body.colliders.push(collider);
            }
            "mass" => {
                self.spec.mass = args.plain("a mass in kilograms", 0.0..=1e9)?;
                self.spec.body.mass_centre = args.model_place("the mass")?;
            }
            "axis" => self.spec.body.axle = parts::axle(&mut args)?,
            "axel" | "axle" => self.axle(line, &mut args)?,
            "wheel" => self.wheel(&mut args)?,
            "psd" => self.psd(line, &mut args)?,
            "lidar" => self.lidar(line, &mut args)?,
            "camera" => self.camera(&mut args)?,
            "fisheye" => {
                let angle = args.degrees("the lens's angle", 1.0..=360.0)?;
                self.camera_view = Some((units::from_deg(angle), true));
            }
            _ if self.own_line(&keyword, line, &mut args)? => {}
            _ => {
                let message = format!("unknown keyword {}; the line is skipped", shown(line.words[0].text));
                self.notes.warn(line.location(0), message);
                return Ok(());
            }
        }
        args.finish(&mut self.notes);
        Ok(())
    }

    /// Lines unknown to EyeSim. Returns whether the keyword is one of them.
    fn own_line(
        &mut self,
        keyword: &str,
        line: &Line<'_>,
        args: &mut Args<'_, '_>,
    ) -> Result<bool, FormatError> {
        match keyword {
            "motor" => {
                self.spec.motor.time_constant = args.plain("the motors' lag in seconds", 0.0..=1e6)?;
                self.spec.motor.max_acceleration =
                    args.positive_size("the highest acceleration per second squared")?;
            }
            "steering" => {
                let degrees = args.degrees("the largest steering angle", f64::MIN_POSITIVE..=90.0)?;
                self.steering = units::from_deg(degrees);
            }
            "tracks" => {
                let length = args.positive_size("the belts' length on the ground")?;
                self.tracks = Some([length, args.positive_size("the belts' width")?]);
            }
            "friction" => {
                self.spec.friction = args.plain("the coefficient of friction", 0.0..=1e9)?;
            }
            "depth_sensor" => {
                let channel = args.count("the depth sensor's channel", 1..=255)? as u8;
                let z = if args.left() > 0 { args.length("the depth sensor's height")? } else { 0.0 };
                self.spec.depth_sensor = Some(DepthSensorSpec { channel, z });
            }
            "dvl" => self.spec.dvl = Some(args.positive_size("the Doppler log's range")?),
            "compass" => self.spec.compass = true,
            "inertial" => self.spec.inertial = parts::inertial(line, args)?,
            "dynamics" => self.dynamics = Some(parts::dynamics(args)?),
            "outline" => self.outline = Some(parts::outline(line, args)?),
            "mast" => self.mast = Some((parts::mast(line, args)?, line.location(0))),
            "psd_range" => {
                let range = args.positive_size("the sensor's range")?;
                let last = self.psds.last_mut().ok_or_else(|| line.error(0, "a `psd` line before it"))?;
                last.max_range = range;
            }
            "lidar_range" => self.lidar_range = Some(args.positive_size("the lidar's range")?),
            "camera_view" => {
                let angle = args.degrees("the camera's angle", f64::MIN_POSITIVE..=360.0)?;
                self.camera_view = Some((units::from_deg(angle), false));
            }
            _ => return self.craft.line(keyword, line, args),
        }
        Ok(true)
    }

    fn drive(&mut self, line: &Line<'_>, args: &mut Args<'_, '_>) -> Result<(), FormatError> {
        let name = args.word("the name of a drive")?.text;
        // Further words are ignored.
        self.drive = Some(match name.to_ascii_uppercase().as_str() {
            "DIFFERENTIAL_DRIVE" => Drive::Differential,
            "ACKERMANN_DRIVE" => Drive::Ackermann,
            "OMNI_DRIVE" => Drive::Omni,
            "AUV_DRIVE" => Drive::Submarine,
            "BOAT_DRIVE" => Drive::Boat,
            "TRACKED_DRIVE" | "TRACK_DRIVE" | "CHAIN_DRIVE" => Drive::Tracked,
            _ => {
                let read = "read as DIFFERENTIAL_DRIVE with a `wheel` line, as AUV_DRIVE without one";
                self.notes.warn(line.location(1), format!("unknown drive {}; {read}", shown(name)));
                Drive::Unknown
            }
        });
        Ok(())
    }

    fn model(&mut self, args: &mut Args<'_, '_>) -> Result<(), FormatError> {
        self.spec.model = Some(PathBuf::from(args.path("the model's file", &[".obj"], &mut self.notes)?));
        let body = &mut self.spec.body;
        if args.left() > 0 {
            let mut length = |axis| args.length(&format!("the model's {axis}"));
            body.model_offset = [length("x")?, length("y")?, length("z")?];
            let mut angle = |axis| args.direction(&format!("the model's rotation {axis}"));
            body.model_rotation = [angle("x")?, angle("y")?, angle("z")?];
        }
        Ok(())
    }

    fn axle(&mut self, line: &Line<'_>, args: &mut Args<'_, '_>) -> Result<(), FormatError> {
        match args.word("`drive` or `turn`")?.text.to_ascii_lowercase().as_str() {
            "drive" => self.spec.body.axle = parts::axle(args)?,
            "turn" => {
                let [ahead, up] = parts::axle(args)?;
                self.spec.body.turn_axle_height = up;
                self.turn_axle = Some(ahead);
            }
            _ => return Err(line.error(1, "`drive` or `turn`")),
        }
        Ok(())
    }

    fn wheel(&mut self, args: &mut Args<'_, '_>) -> Result<(), FormatError> {
        let first = args.peek().map_or(String::new(), |word| word.text.to_ascii_lowercase());
        if first == "drive" || first == "turn" {
            args.word("`drive` or `turn`")?;
        }
        let wheel = Wheel::read(args)?;
        // Steered wheels only roll, so they are used only if there are no others.
        if first != "turn" || self.wheel.is_none() {
            self.wheel = Some(wheel);
        }
        Ok(())
    }

    fn psd(&mut self, line: &Line<'_>, args: &mut Args<'_, '_>) -> Result<(), FormatError> {
        check_parts(line, self.psds.len())?;
        let shared = mounts::number_first(line);
        let mut id = 0;
        if shared {
            id = args.count("the sensor's number", 0..=255)?;
        }
        let name = args.word("the sensor's name")?.text.to_string();
        if !shared {
            id = args.count("the sensor's number", 0..=255)?;
        }
        let numbers = args.numbers_ahead();
        let one_angle = numbers == 4 || (!shared && numbers != 6);
        let raw =
            if one_angle { Raw::read_with_yaw(args, "the sensor")? } else { Raw::read(args, "the sensor")? };
        if raw.rotation[1] != 0.0 && raw.rotation[2] != 0.0 {
            let message = "a sensor of one ray turned about its line of sight, which changes nothing";
            self.notes.warn(line.location(6), message);
        }
        if self.psds.iter().any(|psd| u32::from(psd.id) == id) {
            self.notes.warn(line.location(0), format!("a second sensor with the number {id}"));
        }
        let max_range = PsdSpec::DEFAULT_MAX_RANGE;
        self.psds.push(Psd { id: id as u8, name, raw, shared: shared && !one_angle, max_range });
        Ok(())
    }

    fn lidar(&mut self, line: &Line<'_>, args: &mut Args<'_, '_>) -> Result<(), FormatError> {
        let mut lidar = LidarSpec::default();
        let numbers = args.left();
        if numbers > 3 {
            self.lidar_mount = Some(Raw::read(args, "the lidar")?);
        }
        if numbers > 2 {
            lidar.field_of_view =
                units::from_deg(args.degrees("the lidar's range", f64::MIN_POSITIVE..=360.0)?);
        }
        let points = |args: &mut Args<'_, '_>| args.count("the lidar's points", 1..=100_000);
        let tilt = |args: &mut Args<'_, '_>| args.degrees("the lidar's tilt", -90.0..=90.0);
        let (count, degrees) = if numbers > 3 {
            let degrees = tilt(args)?;
            (points(args)?, degrees)
        } else if numbers >= 2 {
            (points(args)?, tilt(args)?)
        } else {
            return Err(line.error(1 + numbers, "2, 3 or 9 numbers for the lidar"));
        };
        (lidar.points, lidar.tilt) = (count as usize, units::from_deg(degrees));
        self.spec.lidar = Some(lidar);
        Ok(())
    }

    fn camera(&mut self, args: &mut Args<'_, '_>) -> Result<(), FormatError> {
        let mut length = |axis| args.length(&format!("the camera's {axis}"));
        self.camera_place = Some([length("x")?, length("y")?, length("z")?]);
        let pan = args.direction("the camera's pan")?;
        let tilt = args.direction("the camera's tilt")?;
        let mut limit = |what| args.degrees(what, 0.0..=3600.0).map(units::from_deg);
        self.spec.camera = Some(CameraSpec {
            mount: Mount { yaw: pan, ..Mount::default() },
            tilt,
            max_pan: limit("the camera's largest pan")?,
            max_tilt: limit("the camera's largest tilt")?,
            field_of_view: CameraSpec::DEFAULT_FIELD_OF_VIEW,
            fisheye: false,
        });
        Ok(())
    }
}

fn check_parts(line: &Line<'_>, count: usize) -> Result<(), FormatError> {
    if count < MAX_PARTS { Ok(()) } else { Err(line.error(0, format!("at most {MAX_PARTS} of them"))) }
}
