//! Requests and replies as bytes, for programs in their own processes that share a world.
//!
//! A question contains the time spent by the program, the readings it will want as well, and the request: a
//! number for its kind, and its arguments. An answer contains the robot's time, these readings, and the
//! reply: a number for its kind, and a value or an error. Numbers are little-endian. All input is validated.

use image::RgbImage;
use roverlab::geometry::{Pose, Twist};
use roverlab::io::{Error, ErrorKind, LidarSettings, RadioMessage, Result};
use roverlab::world::InertialSpec;

use crate::ask::{Reply, Request};
use crate::identity::Identity;

/// Maximum size of a reply (bytes): an image of five million pixels and its header.
pub const LONGEST: usize = 16 << 20;
/// Maximum size of a request (bytes): a radio message and its header.
pub const LONGEST_REQUEST: usize = 70_000;

/// A request with the time spent by the program in local calls.
#[derive(Debug, Clone, PartialEq)]
pub struct Question {
    /// Time (s).
    pub debt: f64,
    /// Recent readings, likely to be needed again after the request.
    pub wanted: Vec<Request>,
    /// The request.
    pub request: Request,
}

/// A reply with the robot's time after it.
#[derive(Debug)]
pub struct Answer {
    /// Time (s).
    pub now: f64,
    /// The wanted readings.
    pub readings: Vec<Reply>,
    /// The reply.
    pub reply: Result<Reply>,
}

struct Writer(Vec<u8>);

impl Writer {
    fn new() -> Self {
        Self(Vec::new())
    }

    fn byte(mut self, value: u8) -> Self {
        self.0.push(value);
        self
    }

    fn word(mut self, value: u32) -> Self {
        self.0.extend(value.to_le_bytes());
        self
    }

    fn number(mut self, value: f64) -> Self {
        self.0.extend(value.to_le_bytes());
        self
    }

    fn bytes(mut self, value: &[u8]) -> Self {
        self.0.extend(value);
        self
    }

    fn pose(self, pose: Pose) -> Self {
        self.number(pose.x).number(pose.y).number(pose.heading)
    }

    fn channels(self, channels: Option<[u8; 3]>) -> Self {
        self.bytes(&channels.unwrap_or_default())
    }

    fn request(self, request: &Request) -> Self {
        let w = self;
        match *request {
            Request::Identity => w.byte(0),
            Request::Pass(seconds) => w.byte(1).number(seconds),
            Request::SetSpeed(twist) => w.byte(2).number(twist.linear).number(twist.angular),
            Request::Speed => w.byte(3),
            Request::Pose => w.byte(4),
            Request::SetPose(pose) => w.byte(5).pose(pose),
            Request::Curve(length, angle, speed) => w.byte(6).number(length).number(angle).number(speed),
            Request::Remaining => w.byte(7),
            Request::IsDone => w.byte(8),
            Request::WaitDone => w.byte(9),
            Request::IsStalled => w.byte(10),
            Request::Distance(sensor) => w.byte(11).byte(sensor),
            Request::Scan => w.byte(12),
            Request::ConfigureLidar(settings) => {
                w.byte(13).number(settings.field_of_view).number(settings.tilt).word(settings.points as u32)
            }
            Request::SetResolution(number) => w.byte(14).byte(number),
            Request::Image => w.byte(15),
            Request::Send(to, ref data) => w.byte(16).word(to).bytes(data),
            Request::Receive(seconds) => w.byte(17).number(seconds),
            Request::Motor(motor, fraction) => w.byte(18).byte(motor).number(fraction),
            Request::Servo(servo, position) => w.byte(19).byte(servo).number(position),
            Request::Encoder(motor) => w.byte(20).byte(motor),
            Request::ResetEncoder(motor) => w.byte(21).byte(motor),
            Request::RobotAt(id) => w.byte(22).word(id),
            Request::PlaceRobot(id, pose, z) => w.byte(23).word(id).pose(pose).number(z),
            Request::ObjectAt(id) => w.byte(24).word(id),
            Request::PlaceObject(id, pose) => w.byte(25).word(id).pose(pose),
            Request::Numbers => w.byte(26),
            Request::Attitude => w.byte(27),
            Request::Depth => w.byte(30),
            Request::TurnRates => w.byte(28),
            Request::Acceleration => w.byte(29),
        }
    }

    fn reply(self, reply: &Reply) -> Self {
        let w = self;
        match reply {
            Reply::Done => w.byte(0),
            Reply::Misplaced(text) => w.byte(13).bytes(text.as_bytes()),
            Reply::Flag(flag) => w.byte(1).byte(u8::from(*flag)),
            Reply::Number(number) => w.byte(2).number(*number),
            Reply::Count(count) => w.byte(3).bytes(&count.to_le_bytes()),
            Reply::Twist(twist) => w.byte(4).number(twist.linear).number(twist.angular),
            Reply::Pose(pose, elevation) => w.byte(5).pose(*pose).number(*elevation),
            Reply::Ranges(ranges) => ranges.iter().fold(w.byte(6), |w, &range| w.number(range)),
            Reply::Image(image) => w.byte(7).word(image.width()).word(image.height()).bytes(image),
            Reply::Message(None) => w.byte(8),
            Reply::Message(Some(message)) => w.byte(9).word(message.from).bytes(&message.data),
            Reply::Numbers(numbers) => numbers.iter().fold(w.byte(11), |w, &number| w.word(number)),
            Reply::Identity(identity) => w
                .byte(10)
                .word(identity.id)
                .word(identity.robots)
                .word(identity.objects)
                .word(identity.lidar_points)
                .number(identity.top_speed)
                .number(identity.reach)
                .number(identity.tightest_turn)
                .number(identity.full_speed)
                .number(identity.tick_length)
                .byte(u8::from(identity.full_turn))
                .number(identity.call_duration)
                .number(identity.time_limit)
                .byte(u8::from(identity.exact))
                .byte(u8::from(identity.camera))
                .byte(identity.depth_channel)
                .channels(identity.inertial.attitude)
                .channels(identity.inertial.turn_rates)
                .channels(identity.inertial.acceleration),
            Reply::Three([a, b, c]) => w.byte(12).number(*a).number(*b).number(*c),
        }
    }
}

struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (head, rest) = self.0.split_first_chunk::<N>()?;
        self.0 = rest;
        Some(*head)
    }

    fn byte(&mut self) -> Option<u8> {
        self.take::<1>().map(|[byte]| byte)
    }

    fn word(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    fn number(&mut self) -> Option<f64> {
        self.take().map(f64::from_le_bytes)
    }

    fn pose(&mut self) -> Option<Pose> {
        Some(Pose::new(self.number()?, self.number()?, self.number()?))
    }

    #[allow(clippy::option_option, reason = "nothing to read, or no channels")]
    fn channels(&mut self) -> Option<Option<[u8; 3]>> {
        self.take().map(|channels| (channels != [0; 3]).then_some(channels))
    }

    fn request(&mut self) -> Option<Request> {
        let r = self;
        Some(match r.byte()? {
            0 => Request::Identity,
            1 => Request::Pass(r.number()?),
            2 => Request::SetSpeed(Twist::new(r.number()?, r.number()?)),
            3 => Request::Speed,
            4 => Request::Pose,
            5 => Request::SetPose(r.pose()?),
            6 => Request::Curve(r.number()?, r.number()?, r.number()?),
            7 => Request::Remaining,
            8 => Request::IsDone,
            9 => Request::WaitDone,
            10 => Request::IsStalled,
            11 => Request::Distance(r.byte()?),
            12 => Request::Scan,
            13 => {
                let (field_of_view, tilt) = (r.number()?, r.number()?);
                Request::ConfigureLidar(LidarSettings { field_of_view, tilt, points: r.word()? as usize })
            }
            14 => Request::SetResolution(r.byte()?),
            15 => Request::Image,
            16 => Request::Send(r.word()?, r.rest().to_vec()),
            17 => Request::Receive(r.number()?),
            18 => Request::Motor(r.byte()?, r.number()?),
            19 => Request::Servo(r.byte()?, r.number()?),
            20 => Request::Encoder(r.byte()?),
            21 => Request::ResetEncoder(r.byte()?),
            22 => Request::RobotAt(r.word()?),
            23 => Request::PlaceRobot(r.word()?, r.pose()?, r.number()?),
            24 => Request::ObjectAt(r.word()?),
            25 => Request::PlaceObject(r.word()?, r.pose()?),
            26 => Request::Numbers,
            27 => Request::Attitude,
            30 => Request::Depth,
            28 => Request::TurnRates,
            29 => Request::Acceleration,
            _ => return None,
        })
    }

    fn reply(&mut self) -> Option<Reply> {
        let r = self;
        Some(match r.byte()? {
            0 => Reply::Done,
            1 => Reply::Flag(r.byte()? != 0),
            2 => Reply::Number(r.number()?),
            3 => Reply::Count(i64::from_le_bytes(r.take()?)),
            4 => Reply::Twist(Twist::new(r.number()?, r.number()?)),
            5 => Reply::Pose(r.pose()?, r.number()?),
            6 => {
                let (ranges, odd) = r.rest().as_chunks();
                odd.is_empty().then_some(())?;
                Reply::Ranges(ranges.iter().map(|&range| f64::from_le_bytes(range)).collect())
            }
            7 => {
                let (width, height) = (r.word()?, r.word()?);
                Reply::Image(RgbImage::from_raw(width, height, r.rest().to_vec())?)
            }
            8 => Reply::Message(None),
            13 => Reply::Misplaced(String::from_utf8_lossy(r.rest()).into_owned()),
            9 => Reply::Message(Some(RadioMessage { from: r.word()?, data: r.rest().to_vec() })),
            10 => {
                let (id, robots, objects, lidar_points) = (r.word()?, r.word()?, r.word()?, r.word()?);
                Reply::Identity(Identity {
                    id,
                    robots,
                    objects,
                    lidar_points,
                    top_speed: r.number()?,
                    reach: r.number()?,
                    tightest_turn: r.number()?,
                    full_speed: r.number()?,
                    tick_length: r.number()?,
                    full_turn: r.byte()? != 0,
                    call_duration: r.number()?,
                    time_limit: r.number()?,
                    exact: r.byte()? != 0,
                    camera: r.byte()? != 0,
                    depth_channel: r.byte()?,
                    inertial: InertialSpec {
                        attitude: r.channels()?,
                        turn_rates: r.channels()?,
                        acceleration: r.channels()?,
                    },
                })
            }
            12 => Reply::Three([r.number()?, r.number()?, r.number()?]),
            11 => {
                let (numbers, odd) = r.rest().as_chunks();
                odd.is_empty().then_some(())?;
                Reply::Numbers(numbers.iter().map(|&number| u32::from_le_bytes(number)).collect())
            }
            _ => return None,
        })
    }

    fn rest(&mut self) -> &'a [u8] {
        std::mem::take(&mut self.0)
    }

    fn finish<T>(self, value: T) -> Option<T> {
        self.0.is_empty().then_some(value)
    }
}

impl Question {
    /// Encodes the question.
    pub fn encode(&self) -> Vec<u8> {
        let w = Writer::new().number(self.debt).byte(self.wanted.len() as u8);
        let w = self.wanted.iter().fold(w, Writer::request);
        w.request(&self.request).0
    }

    /// Decodes a question; `None` for invalid bytes.
    pub fn decode(frame: &[u8]) -> Option<Self> {
        let mut r = Reader(frame);
        let debt = r.number()?;
        let count = r.byte()?;
        let wanted = (0..count).map(|_| r.request()).collect::<Option<_>>()?;
        let request = r.request()?;
        let debt_is_sound = debt.is_finite() && debt >= 0.0;
        r.finish(Self { debt, wanted, request }).filter(|_| debt_is_sound)
    }
}

const KINDS: [ErrorKind; 7] = [
    ErrorKind::Unsupported,
    ErrorKind::Disconnected,
    ErrorKind::TimedOut,
    ErrorKind::InvalidInput,
    ErrorKind::EndOfLog,
    ErrorKind::Diverged,
    ErrorKind::Other,
];

impl Answer {
    /// Encodes the answer.
    pub fn encode(&self) -> Vec<u8> {
        let w = Writer::new().number(self.now).byte(self.readings.len() as u8);
        let w = self.readings.iter().fold(w, Writer::reply);
        match &self.reply {
            Err(error) => {
                let kind = KINDS.iter().position(|&kind| kind == error.kind()).unwrap_or(KINDS.len() - 1);
                w.byte(255).byte(kind as u8).bytes(error.to_string().as_bytes())
            }
            Ok(reply) => w.reply(reply),
        }
        .0
    }

    /// Decodes an answer; `None` for invalid bytes.
    pub fn decode(frame: &[u8]) -> Option<Self> {
        let mut r = Reader(frame);
        let now = r.number()?;
        let count = r.byte()?;
        let readings = (0..count).map(|_| r.reply()).collect::<Option<_>>()?;
        let mut ahead = Reader(r.0);
        let reply = if ahead.byte()? == 255 {
            r = ahead;
            let kind = *KINDS.get(usize::from(r.byte()?))?;
            Err(Error::new(kind, String::from_utf8_lossy(r.rest())))
        } else {
            Ok(r.reply()?)
        };
        r.finish(Self { now, readings, reply })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use roverlab::random::Stream;

    #[test]
    fn questions_survive() {
        let pose = Pose::new(1.0, -2.0, 0.5);
        let settings = LidarSettings { field_of_view: 3.0, tilt: 0.1, points: 77 };
        for request in [
            Request::Identity,
            Request::Curve(1.0, 2.0, 3.0),
            Request::ConfigureLidar(settings),
            Request::Send(3, vec![1, 2, 3]),
            Request::Send(3, vec![]),
            Request::Receive(0.5),
            Request::Numbers,
            Request::PlaceRobot(8, pose, 0.25),
            Request::PlaceObject(9, pose),
            Request::Servo(2, -0.5),
            Request::Attitude,
            Request::Depth,
            Request::TurnRates,
            Request::Acceleration,
        ] {
            let question =
                Question { debt: 0.25, wanted: vec![Request::Pose, Request::Distance(3)], request };
            assert_eq!(Question::decode(&question.encode()), Some(question));
        }
    }

    #[test]
    fn answers_survive() {
        for reply in [
            Reply::Done,
            Reply::Misplaced("robot 1 is put to 0, 0 mm, in a wall".into()),
            Reply::Flag(true),
            Reply::Count(-5),
            Reply::Three([1.0, -2.0, 0.5]),
            Reply::Numbers(vec![1, 3]),
            Reply::Ranges(vec![1.0, f64::INFINITY]),
            Reply::Image(RgbImage::from_pixel(2, 1, image::Rgb([1, 2, 3]))),
            Reply::Message(Some(RadioMessage { from: 2, data: b"hello".to_vec() })),
        ] {
            let bytes = Answer {
                now: 1.5,
                readings: vec![Reply::Number(2.0), Reply::Flag(false)],
                reply: Ok(reply.clone()),
            }
            .encode();
            let answer = Answer::decode(&bytes).unwrap();
            assert_eq!((answer.now, answer.readings.len(), answer.reply.unwrap()), (1.5, 2, reply));
        }
        let error = Error::new(ErrorKind::TimedOut, "over");
        let bytes = Answer { now: 0.0, readings: Vec::new(), reply: Err(error) }.encode();
        let error = Answer::decode(&bytes).unwrap().reply.unwrap_err();
        assert_eq!((error.kind(), error.to_string()), (ErrorKind::TimedOut, "over".to_owned()));
    }

    /// Frames of which a few bytes were changed.
    #[test]
    fn changed_frames_are_refused_or_survive() {
        let mut stream = Stream::new(2);
        let request = Request::Send(3, vec![1, 2, 3]);
        let question = Question { debt: 0.25, wanted: vec![Request::Pose], request }.encode();
        let readings = vec![Reply::Ranges(vec![1.0; 4])];
        let image = Reply::Image(RgbImage::from_pixel(2, 1, image::Rgb([1, 2, 3])));
        let answer = Answer { now: 1.5, readings, reply: Ok(image) }.encode();
        for _ in 0..10_000 {
            for frame in [&question, &answer] {
                let mut frame = frame[..stream.below(frame.len() + 1)].to_vec();
                for _ in 0..stream.below(4).min(frame.len()) {
                    let place = stream.below(frame.len());
                    frame[place] = stream.below(256) as u8;
                }
                if let Some(question) = Question::decode(&frame) {
                    assert_eq!(Question::decode(&question.encode()), Some(question));
                }
                if let Some(answer) = Answer::decode(&frame) {
                    assert!(Answer::decode(&answer.encode()).is_some(), "{answer:?}");
                }
            }
        }
    }

    #[test]
    fn nonsense_is_refused() {
        let mut stream = Stream::new(1);
        for _ in 0..20_000 {
            let bytes: Vec<u8> = (0..stream.below(60)).map(|_| stream.below(256) as u8).collect();
            let _ = Question::decode(&bytes);
            let _ = Answer::decode(&bytes);
        }
        let endless = Question { debt: f64::INFINITY, wanted: Vec::new(), request: Request::Pose }.encode();
        assert_eq!(Question::decode(&endless), None);
    }
}
