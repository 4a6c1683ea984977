//! Compares every kernel with a naive version of its definition, on random images of all small sizes and
//! strides.

mod bad_input;
mod colour;
mod colour_finder;
mod gradients;
mod naive;
mod shapes;

use proptest::prelude::*;

use super::{View, ViewMut};

/// A random image of `C` bytes per pixel.
#[derive(Debug, Clone)]
struct Image<const C: usize> {
    data: Vec<u8>,
    width: usize,
    height: usize,
    stride: usize,
}

impl<const C: usize> Image<C> {
    fn view(&self) -> View<'_, C> {
        View::with_stride(&self.data, self.width, self.height, self.stride).unwrap()
    }

    /// Bytes of a pixel of the image, mirrored beyond its border.
    fn mirrored(&self, x: isize, y: isize) -> [u8; C] {
        let fold = |i: isize, n: usize| {
            let (mut i, last) = (i, n as isize - 1);
            while i < 0 || i > last {
                i = if last == 0 {
                    0
                } else if i < 0 {
                    -i
                } else {
                    2 * last - i
                };
            }
            i as usize
        };
        self.at(fold(x, self.width), fold(y, self.height))
    }

    fn at(&self, x: usize, y: usize) -> [u8; C] {
        self.data[y * self.stride + x * C..][..C].try_into().unwrap()
    }

    /// Bytes computed pixel by pixel.
    fn map<const D: usize>(&self, f: impl Fn(usize, usize) -> [u8; D]) -> Vec<u8> {
        (0..self.height).flat_map(|y| (0..self.width).flat_map(|x| f(x, y)).collect::<Vec<u8>>()).collect()
    }

    /// Output of a kernel, with a stride of its own; asserts that nothing is written between the rows.
    fn output<const D: usize>(&self, kernel: impl FnOnce(ViewMut<'_, D>)) -> Vec<u8> {
        let row = self.width * D;
        let stride = row + (self.stride - self.width * C);
        let mut data = vec![77; stride * self.height];
        kernel(ViewMut::with_stride(&mut data, self.width, self.height, stride).unwrap());
        let rows = data.chunks(stride);
        assert!(rows.clone().all(|bytes| bytes[row..].iter().all(|&byte| byte == 77)));
        rows.flat_map(|bytes| bytes[..row].to_vec()).collect()
    }
}

/// Images from 1 x 1 pixels: noise, few levels (for ties), or flat areas with steps.
fn images<const C: usize>() -> impl Strategy<Value = Image<C>> {
    let sizes = prop_oneof![3 => 1_usize..12, 2 => 12_usize..150];
    (sizes, 1_usize..12, 0_usize..4, 0_u8..3, any::<u64>()).prop_map(|(width, height, gap, kind, seed)| {
        let stride = width * C + gap;
        let mut stream = crate::random::Stream::new(seed);
        let data = (0..stride * height).map(|place| match kind {
            0 => stream.bits() as u8,
            1 => [0, 1, 127, 128, 254, 255][stream.below(6)],
            _ => ((place / 5 * 97) as u8).wrapping_add((stream.bits() & 3) as u8),
        });
        Image { data: data.collect(), width, height, stride }
    })
}
