//! Duration of calls in program time.
//!
//! EyeSim's simulator handles one request per robot and rendered frame. A *query* returns with the frame that
//! handles it. A *one-way* call returns at once, but occupies a frame and takes effect with it. *Local*
//! calls, to display and keys, never leave the program. So a loop that reads two sensors and sets two motors
//! takes four frames. The figures of local calls are estimates.
//!
//! A file changes them, one call per line:
//!
//! ```text
//! # call    kind      milliseconds, beyond the frame
//! PSDGet    query
//! CAMGet    query     2
//! AUBeep    local     0.5
//! VWSetSpeed one-way  0.02
//! ```

use std::collections::BTreeMap;
use std::path::Path;

use crate::files;

/// Where a call is handled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// In the program.
    Local,
    /// In the simulator, without waiting.
    OneWay,
    /// In the simulator, with a reply.
    Query,
}

/// Cost of a call.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cost {
    /// Where it is handled.
    pub kind: Kind,
    /// Duration in the program itself (ns).
    pub nanoseconds: u64,
    /// Whether the duration is per pixel of an image.
    pub per_pixel: bool,
}

/// Cost model of calls.
#[derive(Debug, Clone, PartialEq)]
pub enum Costs {
    /// A tenth of a millisecond per call.
    Free,
    /// As on EyeSim.
    Frames(Frames),
}

/// Cost model with one request per frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Frames {
    /// Frame rate (Hz).
    rate: f64,
    costs: BTreeMap<&'static str, Cost>,
}

const SECOND: f64 = 1e9;
/// Duration of a one-way call or a simple local one for the caller (ns).
const BRIEF: u64 = 20_000;
/// Duration of printing a text on the display (ns).
const TEXT: u64 = 100_000;
/// Duration per pixel of an image on the display (ns).
const PIXEL: u64 = 10;

const BRIEF_CALL: Cost = Cost { kind: Kind::Local, nanoseconds: BRIEF, per_pixel: false };

/// All calls by cost.
const CALLS: [(Kind, u64, &str); 5] = [
    (
        Kind::Query,
        0,
        "PSDGet PSDGetRaw LIDARGet SIMLaserScan CAMGet CAMGetGray VWGetPosition VWGetSpeed VWDone VWRemain VWWait \
         VWStalled VWDriveDone VWDriveRemain VWDriveWait ENCODERRead SIMGetRobot SIMGetObject SIMGetPose \
         SIMGetRobotCount SIMGetObjectCount RADIOReceive RADIOCheck RADIOGetID RADIOStatus",
    ),
    (
        Kind::OneWay,
        BRIEF,
        "VWSetSpeed VWSetPosition VWStraight VWTurn VWCurve VWDrive MOTORDrive MOTORDriveRaw MOTORPID MOTORPIDOff \
         MOTORSpeed ENCODERReset SERVOSet SERVOSetRaw SERVOSetAngle CAMInit LIDARSet AUBeep AUPlay AUTone RADIOSend \
         SIMSetRobot SIMSetObject SIMSetPose",
    ),
    (Kind::Local, TEXT, "LCDPrintf LCDSetPrintf LCDMenu LCDMenuI OSError"),
    (Kind::Local, PIXEL, "LCDImage LCDImageGray LCDImageBinary"),
    (
        Kind::Local,
        BRIEF,
        "LCDClear LCDSetPos LCDGetPos LCDSetColor LCDSetFont LCDSetFontSize LCDSetMode LCDGetSize LCDPixel LCDGetPixel \
         LCDLine LCDArea LCDCircle LCDImageSize LCDImageStart LCDRefresh LCDInit LCDPixelInvert LCDLineInvert \
         LCDAreaInvert LCDCircleInvert KEYGet KEYRead KEYWait KEYGetXY KEYReadXY IRTVGet IRTVRead IRTVFlush \
         IRTVGetStatus CAMRelease IPSetSize IPReadFile IPWriteFile IPWriteFileGray IPLaplace IPSobel IPCol2Gray \
         IPGray2Col IPRGB2Col IPCol2HSI IPOverlay IPOverlayGray OSExecute OSVersion OSVersionIO OSMachineName \
         OSMachineSpeed OSMachineType OSMachineID OSWait OSAttachTimer OSDetachTimer OSSetTime OSGetTime OSGetCount \
         SERInit SERSendChar SERSend SERReceiveChar SERReceive SERCheck SERFlush SERClose AUDone AUMicrophone AURecord \
         AUCheckRecord SERVORange SERVOSetExtension SERVOGet SERVODone SERVOWait SERVOStalled VWControl VWControlOff \
         DIGITALSetup DIGITALRead DIGITALReadAll DIGITALWrite ANALOGRead ANALOGVoltage ANALOGRecord ANALOGTransfer \
         RADIOInit RADIORelease MTInit MTSleep time",
    ),
];

impl Costs {
    /// Parses `--call-costs`: `eyesim`, `free`, or the name of a file. `rate` is the frame rate (Hz).
    pub fn parse(text: &str, rate: f64) -> Result<Self, String> {
        match text {
            "free" => Ok(Self::Free),
            "eyesim" => Ok(Self::Frames(Frames::new(rate))),
            file => {
                let expected = "eyesim, free, or a file of calls and what they take";
                let text = files::read_text(Path::new(file), expected)?;
                Ok(Self::Frames(Frames::new(rate).changed(&text, file)?))
            }
        }
    }
}

impl Frames {
    /// EyeSim's costs at a frame rate (Hz).
    pub fn new(rate: f64) -> Self {
        let mut costs = BTreeMap::new();
        for (kind, nanoseconds, names) in CALLS {
            let per_pixel = nanoseconds == PIXEL;
            let cost = Cost { kind, nanoseconds, per_pixel };
            costs.extend(names.split_whitespace().map(|name| (name, cost)));
        }
        Self { rate, costs }
    }

    /// Applies a file's changes.
    fn changed(mut self, text: &str, file: &str) -> Result<Self, String> {
        for (number, line) in text.lines().enumerate() {
            let content = line.split_once('#').map_or(line, |(content, _)| content);
            let words: Vec<&str> = content.split_whitespace().collect();
            let wrong = |word: &str, expected: &str| {
                let column = word.as_ptr().addr() - line.as_ptr().addr() + 1;
                Err(format!("{file}:{}:{column}: `{word}`; expected {expected}", number + 1))
            };
            let (name, kind, time) = match words[..] {
                [] => continue,
                [name, kind] => (name, kind, "0"),
                [name, kind, time] => (name, kind, time),
                _ => return wrong(words[0], "a call, its kind, and milliseconds"),
            };
            let Some(cost) = self.costs.get_mut(name) else {
                return wrong(name, "the name of a RoBIOS call");
            };
            let kind = match kind {
                "local" => Kind::Local,
                "one-way" => Kind::OneWay,
                "query" => Kind::Query,
                other => return wrong(other, "local, one-way or query"),
            };
            let Some(time) = time.parse().ok().filter(|time: &f64| (0.0..=1e6).contains(time)) else {
                return wrong(time, "milliseconds from 0 to a million");
            };
            *cost = Cost { kind, nanoseconds: (time * SECOND / 1e3).round() as u64, per_pixel: false };
        }
        Ok(self)
    }

    /// Cost of a call.
    pub fn of(&self, call: &str) -> Cost {
        self.costs.get(call).copied().unwrap_or(BRIEF_CALL)
    }

    /// Time at which a frame is rendered, since the start (ns).
    pub fn time(&self, frame: u64) -> u64 {
        (frame as f64 * SECOND / self.rate).round() as u64
    }

    /// Number of the first frame after a time (ns).
    pub fn after(&self, time: u64) -> u64 {
        let mut frame = (time as f64 * self.rate / SECOND) as u64;
        while self.time(frame) <= time {
            frame += 1;
        }
        frame
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_follow_each_other() {
        for rate in [60.0, 24.0, 120.0, 59.94] {
            let frames = Frames::new(rate);
            for frame in 0..1000 {
                assert_eq!(frames.after(frames.time(frame)), frame + 1, "{rate}");
                assert_eq!(frames.after(frames.time(frame + 1) - 1), frame + 1, "{rate}");
            }
        }
        assert_eq!(Frames::new(60.0).time(3), 50_000_000);
    }

    #[test]
    fn files_change_what_they_name() {
        let text = "# mine\nPSDGet local 0.5\nLCDPixel query # slow\n\n";
        let frames = Frames::new(60.0).changed(text, "costs").unwrap();
        assert_eq!(frames.of("PSDGet"), Cost { kind: Kind::Local, nanoseconds: 500_000, per_pixel: false });
        assert_eq!(frames.of("LCDPixel").kind, Kind::Query);
        assert_eq!(frames.of("VWSetSpeed"), Frames::new(60.0).of("VWSetSpeed"));
        for (text, message) in [
            ("PSDGett query", "costs:1:1: `PSDGett`; expected the name of a RoBIOS call"),
            ("\nPSDGet slow", "costs:2:8: `slow`; expected local, one-way or query"),
            ("PSDGet query -1", "costs:1:14: `-1`; expected milliseconds from 0 to a million"),
            ("PSDGet", "costs:1:1: `PSDGet`; expected a call, its kind, and milliseconds"),
        ] {
            assert_eq!(Frames::new(60.0).changed(text, "costs").unwrap_err(), message);
        }
        assert!(Costs::parse("no such file", 60.0).unwrap_err().contains("expected eyesim, free"));
    }

    /// Every call of the header has a row.
    #[test]
    fn no_call_is_forgotten() {
        let header = include_str!("../include/eyebot.h");
        let names = header.lines().filter_map(|line| {
            let (before, _) = line.split_once('(')?;
            let name = before.split(|c: char| !c.is_alphanumeric() && c != '_').next_back()?;
            (!line.starts_with(['#', ' ', '/', '*']) && name.starts_with(char::is_uppercase)).then_some(name)
        });
        let frames = Frames::new(60.0);
        // These use neither robot nor clock, or are aliases.
        let aside = [
            "MTSpawn",
            "MTGetUID",
            "MTKill",
            "SEMAInit",
            "SEMALock",
            "SEMAUnlock",
            "XInitThreads",
            "LCDFontSize",
            "MOTORPIDoff",
            "AUCheckTone",
            "AUCheckPlay",
        ];
        let mut count = 0;
        for name in names.filter(|name| !name.starts_with("IPP") && !aside.contains(name)) {
            assert!(frames.costs.contains_key(name), "{name}");
            count += 1;
        }
        assert!(count > 100, "{count}");
    }
}
