use std::collections::{BTreeMap, VecDeque};

use roverlab::geometry::units;
use roverlab::io::Result;
use roverlab::world::formats::DiskFiles;

use super::{Robios, invalid};
use crate::ask::{Reply, Request};

/// Digital and analog lines and serial ports, which have no simulated counterpart. They are looped back: a
/// program reads what it wrote.
#[derive(Debug)]
pub struct Lines {
    digital: [Digital; 16],
    ports: BTreeMap<i32, VecDeque<u8>>,
    recorded: Vec<u8>,
}

#[derive(Debug, Clone, Copy)]
struct Digital {
    direction: u8,
    state: bool,
}

impl Default for Lines {
    /// Lines 1 to 8 are inputs with a pull-up resistor, 9 to 16 outputs at 0.
    fn default() -> Self {
        let line = |index| {
            if index < 8 {
                Digital { direction: b'I', state: true }
            } else {
                Digital { direction: b'o', state: false }
            }
        };
        Self { digital: std::array::from_fn(line), ports: BTreeMap::new(), recorded: Vec::new() }
    }
}

/// Ports of `SERInit`: the serial port, 0, and 20 USB devices.
const PORTS: std::ops::RangeInclusive<i32> = 0..=20;
/// Maximum number of bytes waiting in a port; further ones are lost.
const LONGEST_QUEUE: usize = 65_536;
/// Supply voltage (0.01 V): a battery of two cells, fully charged.
const SUPPLY: i32 = 820;
/// Reading of an unconnected channel, of 0 to 255.
const SILENCE: u8 = 0;
/// Maximum number of samples per recording.
const LONGEST_RECORDING: i32 = 65_536;
/// What is said of digital lines.
const NO_LINES: &str = "nothing is connected to the digital lines, which read what was written to them";
/// Duration of a sound (s).
const SOUND: f64 = 0.5;

/// From metres, radians and seconds to what a channel reads.
type Scale = fn(f64) -> f64;

impl Robios {
    /// `DIGITALSetup`.
    pub fn digital_setup(&mut self, line: i32, direction: u8) -> Result<()> {
        let index = line_index(line)?;
        let state = match direction {
            b'i' | b'J' | b'o' => false,
            b'I' => true,
            _ => return Err(invalid("direction", direction, "i, I, J or o")),
        };
        self.lines.digital[index] = Digital { direction, state };
        self.charge()
    }

    /// `DIGITALRead`.
    pub fn digital_read(&mut self, line: i32) -> Result<i32> {
        let index = line_index(line)?;
        self.note(NO_LINES);
        self.charge()?;
        Ok(i32::from(self.lines.digital[index].state))
    }

    /// `DIGITALReadAll`, with line 1 as the lowest bit.
    pub fn digital_read_all(&mut self) -> Result<i32> {
        self.note(NO_LINES);
        self.charge()?;
        Ok(self.lines.digital.iter().rev().fold(0, |bits, line| bits << 1 | i32::from(line.state)))
    }

    /// `DIGITALWrite`.
    pub fn digital_write(&mut self, line: i32, state: i32) -> Result<()> {
        let index = line_index(line)?;
        if self.lines.digital[index].direction != b'o' {
            return Err(invalid("digital line", format!("{line}, an input"), "an output"));
        }
        self.note(NO_LINES);
        self.lines.digital[index].state = state != 0;
        self.charge()
    }

    /// `ANALOGRead`: the inertial unit on its channels, the supply voltage on channel 0, silence elsewhere.
    pub fn analog_read(&mut self, channel: i32) -> Result<i32> {
        if channel != 0 && channel == i32::from(self.identity.depth_channel) {
            let Reply::Number(depth) = self.ask(&Request::Depth)? else { return Err(super::foreign()) };
            return Ok(units::to_mm(depth).round() as i32);
        }
        let unit = self.identity.inertial;
        let tenths_of_degrees = |radians| 10.0 * units::to_deg(radians);
        let groups: [(_, _, Scale); 3] = [
            (unit.attitude, Request::Attitude, tenths_of_degrees),
            (unit.turn_rates, Request::TurnRates, tenths_of_degrees),
            (unit.acceleration, Request::Acceleration, units::to_mm),
        ];
        for (channels, request, scale) in groups {
            let place = channels.and_then(|group| group.iter().position(|&own| i32::from(own) == channel));
            let Some(place) = place else { continue };
            let Reply::Three(numbers) = self.ask(&request)? else { return Err(super::foreign()) };
            return Ok(scale(numbers[place]).round() as i32);
        }
        self.charge()?;
        match channel {
            0 => Ok(SUPPLY),
            1..=8 => {
                self.note(&format!(
                    "nothing is connected to analog channel {channel}, which reads {SILENCE}"
                ));
                Ok(SILENCE.into())
            }
            _ => Err(invalid("analog channel", channel, "0 to 8, or one of the inertial unit")),
        }
    }

    /// `ANALOGVoltage`.
    pub fn analog_voltage(&mut self) -> Result<i32> {
        self.charge()?;
        Ok(SUPPLY)
    }

    /// `ANALOGRecord`.
    pub fn analog_record(&mut self, channel: i32, samples: i32) -> Result<()> {
        if !(0..=8).contains(&channel) || !(0..=LONGEST_RECORDING).contains(&samples) {
            return Err(invalid("recording", format!("{samples} of channel {channel}"), "65536 of 0 to 8"));
        }
        self.note(&format!("nothing is connected to analog channel {channel}, which reads {SILENCE}"));
        self.lines.recorded = vec![SILENCE; samples as usize];
        self.charge()
    }

    /// `ANALOGTransfer`.
    pub fn analog_transfer(&mut self) -> Result<Vec<u8>> {
        self.charge()?;
        Ok(std::mem::take(&mut self.lines.recorded))
    }

    /// `SERInit`.
    pub fn ser_init(&mut self, port: i32, baud: i32) -> Result<()> {
        if !PORTS.contains(&port) || !(50..=230_400).contains(&baud) {
            return Err(invalid("serial port", format!("{port} at {baud} baud"), "0 to 20, 50 to 230400"));
        }
        self.note(&format!("nothing is connected to serial port {port}, which returns what is sent"));
        self.lines.ports.entry(port).or_default().clear();
        self.charge()
    }

    fn port(&mut self, port: i32) -> Result<&mut VecDeque<u8>> {
        let found = self.lines.ports.get_mut(&port);
        found.ok_or_else(|| invalid("serial port", port, "one that SERInit has opened"))
    }

    /// `SERSend` and `SERSendChar`.
    pub fn ser_send(&mut self, port: i32, data: &[u8]) -> Result<()> {
        let queue = self.port(port)?;
        let room = LONGEST_QUEUE - queue.len();
        queue.extend(&data[..data.len().min(room)]);
        self.charge()
    }

    /// `SERReceive` and `SERReceiveChar`: the waiting bytes, at most `most`.
    pub fn ser_receive(&mut self, port: i32, most: usize) -> Result<Vec<u8>> {
        let queue = self.port(port)?;
        let count = queue.len().min(most);
        let data = queue.drain(..count).collect();
        self.charge()?;
        Ok(data)
    }

    /// `SERCheck`: number of waiting bytes.
    pub fn ser_check(&mut self, port: i32) -> Result<i32> {
        let count = self.port(port)?.len();
        self.charge()?;
        Ok(count as i32)
    }

    /// `SERFlush`.
    pub fn ser_flush(&mut self, port: i32) -> Result<()> {
        self.port(port)?.clear();
        self.charge()
    }

    /// `SERClose`.
    pub fn ser_close(&mut self, port: i32) -> Result<()> {
        self.port(port)?;
        self.lines.ports.remove(&port);
        self.charge()
    }

    /// `AUPlay`: counted, whether or not the file exists.
    pub fn au_play(&mut self, sample: &str) -> Result<()> {
        // A program runs in its own folder.
        if DiskFiles::new().find(sample, "").is_none() {
            self.note(&format!("`{sample}` does not exist"));
        }
        self.au_beep()
    }

    /// `AUBeep`: counted.
    pub fn au_beep(&mut self) -> Result<()> {
        self.sounds += 1;
        self.charge()?;
        self.sound_ends = self.now() + SOUND;
        Ok(())
    }

    /// `AUDone`.
    pub fn au_done(&mut self) -> Result<bool> {
        self.charge()?;
        Ok(self.now() >= self.sound_ends)
    }
}

fn line_index(line: i32) -> Result<usize> {
    let index = usize::try_from(line).ok().filter(|_| (1..=16).contains(&line));
    index.map(|index| index - 1).ok_or_else(|| invalid("digital line", line, "1 to 16"))
}
