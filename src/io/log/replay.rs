use image::RgbImage;

use super::call::{self, Call};
use super::parts::{ScanHead, Size};
use super::player::{Player, Position, seconds};
use super::recording::Kind;
use super::values::{self, Put, Take, Values};
use super::{Log, LogError, wire};
use crate::geometry::{Pose, Twist};
use crate::io::{
    Camera, Clock, Display, DisplayOption, DistanceSensors, Drive, Encoders, Error, ErrorKind, Fill, Font,
    Key, Keys, Lidar, LidarScan, LidarSettings, Motors, Picture, Pixel, Psd, Radio, RadioMessage, Resolution,
    Result, Servos, Viewport,
};
use crate::world::Colour;

/// A robot made of a recording: it answers as the recorded one did.
///
/// A program must ask the same questions in the same order, and give the same commands to the bit. The first
/// difference is an error of the kind [`Diverged`](ErrorKind::Diverged) that names the time, the call and what was
/// expected; so is every call after it. A call behind the end of the recording fails with
/// [`EndOfLog`](ErrorKind::EndOfLog).
#[derive(Debug, Clone)]
pub struct Replay {
    position: Position,
    /// What differed.
    difference: Option<String>,
}

impl Replay {
    /// A robot of a recording, by its index.
    pub fn new(log: &Log, robot: usize) -> std::result::Result<Self, LogError> {
        Player::new(log).robot(robot)
    }

    pub(super) fn at(position: Position) -> Self {
        Self { position, difference: None }
    }

    /// What the recording answers to a call. `take` makes it of the recorded result and the bulk before it.
    fn answer<T>(
        &mut self,
        method: &str,
        arguments: &Values,
        take: impl FnOnce(&Values, &[u8]) -> Option<T>,
    ) -> Result<T> {
        if let Some(difference) = &self.difference {
            return Err(Error::new(ErrorKind::Diverged, difference));
        }
        let (here, index) = (self.position.here(), self.position.next_call());
        let position = self.position.clone();
        let Some(event) = position.event(index) else {
            let call = call::shown(method, arguments);
            return Err(Error::new(
                ErrorKind::EndOfLog,
                format!("the recording has ended before the call {call}"),
            ));
        };
        let time = seconds(event.time);
        let recorded = Call::read(position.log().data(event)).ok_or_else(|| unreadable(time))?;
        if recorded.method != method || recorded.arguments != *arguments {
            let found = call::shown(method, arguments);
            let expected = call::shown(recorded.method, &recorded.arguments);
            return Err(self
                .diverge(format!("at {time} s: found the call {found}; expected {expected}, as recorded")));
        }
        position.move_to(index + 1);
        let bulk =
            (here..index).filter_map(|index| position.event(index)).rfind(|event| event.kind == Kind::Bulk);
        match recorded.result {
            Ok(result) => take(&result, bulk.map_or(&[], |bulk| position.log().data(bulk)))
                .ok_or_else(|| unreadable(time)),
            Err(failure) => Err(failure.error()),
        }
    }

    fn diverge(&mut self, difference: String) -> Error {
        let error = Error::new(ErrorKind::Diverged, &difference);
        self.difference = Some(difference);
        error
    }

    /// A call whose result holds all of its answer.
    fn plain<T: Take>(&mut self, method: &str, arguments: &Values) -> Result<T> {
        self.answer(method, arguments, |result, _| result.take())
    }
}

fn unreadable(time: f64) -> Error {
    Error::new(ErrorKind::Other, format!("at {time} s: the recording holds no readable answer"))
}

impl Clock for Replay {
    fn now(&mut self) -> Result<f64> {
        self.plain("now", &Values::default())
    }

    fn wait(&mut self, seconds: f64) -> Result<()> {
        self.plain("wait", &Values::of(&seconds))
    }

    fn peek_time(&mut self) -> Result<f64> {
        let next = self.position.event(self.position.next_call());
        next.map(|event| seconds(event.time))
            .ok_or_else(|| Error::new(ErrorKind::EndOfLog, "the recording has ended"))
    }
}

impl Lidar for Replay {
    fn scan_into(&mut self, scan: &mut LidarScan) -> Result<()> {
        self.answer("scan_into", &Values::default(), |head, bulk| {
            let head: ScanHead = head.take()?;
            head.fill(scan, wire::doubles(wire::bytes_of(bulk, 6).unwrap_or_default())?);
            Some(())
        })
    }

    fn configure_lidar(&mut self, settings: LidarSettings) -> Result<()> {
        self.plain("configure_lidar", &Values::of(&settings))
    }
}

impl Camera for Replay {
    fn set_resolution(&mut self, resolution: Resolution) -> Result<()> {
        self.plain("set_resolution", &Values::of(&resolution))
    }

    fn resolution(&mut self) -> Result<Resolution> {
        self.plain("resolution", &Values::default())
    }

    fn image_into(&mut self, image: &mut RgbImage) -> Result<()> {
        self.answer("image_into", &Values::default(), |size, bulk| {
            let Size(width, height) = size.take()?;
            let mut data = std::mem::take(image).into_raw();
            data.clear();
            data.extend_from_slice(wire::bytes_of(bulk, 6).unwrap_or_default());
            *image = values::image(width, height, data)?;
            Some(())
        })
    }
}

macro_rules! replayed {
    ($capability:ident { $( fn $name:ident($($arg:ident: $type:ty),*) -> $result:ty; )* }) => {
        impl $capability for Replay {
            $( fn $name(&mut self $(, $arg: $type)*) -> Result<$result> {
                #[allow(unused_mut, reason = "some calls have no arguments")]
                let mut arguments = Values::default();
                $( $arg.put(&mut arguments); )*
                self.plain(stringify!($name), &arguments)
            } )*
        }
    };
}

signatures! { Drive => replayed!() }
signatures! { DistanceSensors => replayed!() }
signatures! { Display => replayed!() }
signatures! { Keys => replayed!() }
signatures! { Radio => replayed!() }
signatures! { Motors => replayed!() }
signatures! { Servos => replayed!() }
signatures! { Encoders => replayed!() }
