//! GPS times in LAZ files, passed over.
//!
//! Fields of a point are coded one after the other, so a time has to be decoded to reach what comes after it.
//! The decoder of `laz` calls itself for each change from one of four sequences of times to another. Nothing
//! bounds these changes, and a file can make it use up the stack. A compressor changes once for a time at most.

use laz::{
    decoders::ArithmeticDecoder,
    decompressors::{IntegerDecompressor, IntegerDecompressorBuilder},
    models::{ArithmeticModel, ArithmeticModelBuilder},
    record::FieldDecompressor,
};
use std::io::{self, ErrorKind, Read};

/// Changes of the sequence within one time. The compressor makes one, others may be less direct.
const MAX_CHANGES: usize = 3;

/// Multiples of the last difference have separate symbols up to here, and down to [`MIN_MULTIPLE`].
const MAX_MULTIPLE: i32 = 500;
const MIN_MULTIPLE: i32 = -10;
/// The time is the last one.
const UNCHANGED: i32 = MAX_MULTIPLE - MIN_MULTIPLE + 1;
/// The time has all its 64 bits. Higher symbols change the sequence.
const FULL: i32 = UNCHANGED + 1;
const NUM_SYMBOLS: u32 = FULL as u32 + 4;

/// The same symbols after a difference of zero.
const FULL_AFTER_ZERO: i32 = 2;
const NUM_SYMBOLS_AFTER_ZERO: u32 = 6;

/// After this many differences that are not a multiple of the last one, the last one is replaced.
const MAX_EXTREMES: u32 = 3;

/// Decodes times of version 2 and forgets them.
pub(super) struct GpsTimeSkipper {
    multiples: ArithmeticModel,
    after_zero: ArithmeticModel,
    differences: IntegerDecompressor,
    /// Which of the sequences is current, and which began last.
    current: usize,
    newest: usize,
    sequences: [Sequence; 4],
}

#[derive(Clone, Copy, Default)]
struct Sequence {
    last_difference: i32,
    num_extremes: u32,
}

/// What a symbol asked for.
enum Step {
    Done,
    ChangeBy(usize),
}

impl Default for GpsTimeSkipper {
    fn default() -> Self {
        Self {
            multiples: ArithmeticModelBuilder::new(NUM_SYMBOLS).build(),
            after_zero: ArithmeticModelBuilder::new(NUM_SYMBOLS_AFTER_ZERO).build(),
            differences: IntegerDecompressorBuilder::new().bits(32).contexts(9).build_initialized(),
            current: 0,
            newest: 0,
            sequences: [Sequence::default(); 4],
        }
    }
}

impl<R: Read> FieldDecompressor<R> for GpsTimeSkipper {
    fn size_of_field(&self) -> usize {
        size_of::<f64>()
    }

    fn decompress_first(&mut self, source: &mut R, first: &mut [u8]) -> io::Result<()> {
        source.read_exact(first)
    }

    /// Leaves the field as it is.
    fn decompress_with(&mut self, decoder: &mut ArithmeticDecoder<R>, _: &mut [u8]) -> io::Result<()> {
        for _ in 0..=MAX_CHANGES {
            let step = if self.sequence().last_difference == 0 {
                self.skip_after_zero(decoder)?
            } else {
                self.skip_multiple(decoder)?
            };
            match step {
                Step::Done => return Ok(()),
                Step::ChangeBy(count) => self.current = (self.current + count) % self.sequences.len(),
            }
        }
        Err(io::Error::new(ErrorKind::InvalidData, "a GPS time changes its sequence again and again"))
    }
}

impl GpsTimeSkipper {
    fn sequence(&mut self) -> &mut Sequence {
        &mut self.sequences[self.current]
    }

    fn skip_after_zero<R: Read>(&mut self, decoder: &mut ArithmeticDecoder<R>) -> io::Result<Step> {
        match decoder.decode_symbol(&mut self.after_zero)? as i32 {
            0 => {}
            1 => {
                let last_difference = self.differences.decompress(decoder, 0, 0)?;
                *self.sequence() = Sequence { last_difference, num_extremes: 0 };
            }
            FULL_AFTER_ZERO => self.skip_full(decoder)?,
            symbol => return Ok(Step::ChangeBy((symbol - FULL_AFTER_ZERO) as usize)),
        }
        Ok(Step::Done)
    }

    fn skip_multiple<R: Read>(&mut self, decoder: &mut ArithmeticDecoder<R>) -> io::Result<Step> {
        let symbol = decoder.decode_symbol(&mut self.multiples)? as i32;
        match symbol {
            0..UNCHANGED => self.skip_difference(decoder, symbol)?,
            UNCHANGED => {}
            FULL => self.skip_full(decoder)?,
            _ => return Ok(Step::ChangeBy((symbol - FULL) as usize)),
        }
        Ok(Step::Done)
    }

    /// A difference near a multiple of the last one.
    fn skip_difference<R: Read>(
        &mut self,
        decoder: &mut ArithmeticDecoder<R>,
        symbol: i32,
    ) -> io::Result<()> {
        let multiple = if symbol <= MAX_MULTIPLE { symbol } else { MAX_MULTIPLE - symbol };
        let (context, is_extreme) = match multiple {
            0 => (7, true),
            1 => (1, false),
            2..10 => (2, false),
            10..MAX_MULTIPLE => (3, false),
            MAX_MULTIPLE => (4, true),
            MIN_MULTIPLE => (6, true),
            _ => (5, false),
        };
        let expected = multiple.wrapping_mul(self.sequence().last_difference);
        let difference = self.differences.decompress(decoder, expected, context)?;
        let sequence = self.sequence();
        if is_extreme {
            sequence.num_extremes += 1;
        } else if multiple == 1 {
            sequence.num_extremes = 0;
        }
        if sequence.num_extremes > MAX_EXTREMES {
            *sequence = Sequence { last_difference: difference, num_extremes: 0 };
        }
        Ok(())
    }

    /// A time that begins a new sequence: its upper half is coded, its lower half stored.
    fn skip_full<R: Read>(&mut self, decoder: &mut ArithmeticDecoder<R>) -> io::Result<()> {
        // The bits do not depend on what is expected.
        self.differences.decompress(decoder, 0, 8)?;
        decoder.read_int()?;
        self.newest = (self.newest + 1) % self.sequences.len();
        self.current = self.newest;
        *self.sequence() = Sequence::default();
        Ok(())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)] // A failed unwrap is a failed test.
mod tests {
    use super::*;
    use laz::{
        encoders::ArithmeticEncoder,
        las::{
            gps::v2::GpsTimeCompressor,
            rgb::v2::{LasRGBCompressor, LasRGBDecompressor},
        },
        record::{
            RecordCompressor, RecordDecompressor, SequentialPointRecordCompressor,
            SequentialPointRecordDecompressor,
        },
    };
    use std::io::Cursor;

    const RECORD_BYTES: usize = 14;

    /// Times of several flight lines and pulses, each followed by a colour of its own.
    fn records(num_records: u32) -> Vec<u8> {
        let mut time = 400_000_000.0f64;
        let record = |k: u32| {
            let hash = k.wrapping_mul(0x9e37_79b9) >> 8;
            time += match hash % 97 {
                0 => 1e6,
                1..4 => -1e6,
                4..20 => 0.0,
                20..40 => f64::from(hash % 1000) * 1e-5,
                40..50 => -1e-6 * f64::from(hash % 13),
                50..52 => 0.01,
                _ => 2e-5,
            };
            let colour = [k as u16, hash as u16, 7].map(u16::to_le_bytes);
            [time.to_le_bytes().as_slice(), colour.as_flattened()].concat()
        };
        (0..num_records).flat_map(record).collect()
    }

    #[test]
    fn what_comes_behind_a_time_is_reached() {
        let records = records(20_000);
        let mut compressor = SequentialPointRecordCompressor::new(Cursor::new(Vec::new()));
        compressor.add_field_compressor(GpsTimeCompressor::default());
        compressor.add_field_compressor(LasRGBCompressor::default());
        compressor.compress_many(&records).unwrap();
        compressor.done().unwrap();
        let compressed = compressor.into_inner().into_inner();

        let mut decompressor = SequentialPointRecordDecompressor::new(Cursor::new(compressed));
        decompressor.add_field_decompressor(GpsTimeSkipper::default());
        decompressor.add_field_decompressor(LasRGBDecompressor::default());
        let mut found = vec![0; records.len()];
        decompressor.decompress_many(&mut found).unwrap();
        let colours = |records: &[u8]| -> Vec<u8> {
            records.chunks_exact(RECORD_BYTES).flat_map(|record| record[8..].to_vec()).collect()
        };
        assert_eq!(colours(&found), colours(&records));
    }

    /// Passes over a time that changes its sequence so often before it is the last one again.
    fn skip_changes(num_changes: usize) -> io::Result<()> {
        let mut encoder = ArithmeticEncoder::new(Vec::new());
        let mut model = ArithmeticModelBuilder::new(NUM_SYMBOLS_AFTER_ZERO).with_compression(true).build();
        for _ in 0..num_changes {
            encoder.encode_symbol(&mut model, FULL_AFTER_ZERO as u32 + 1).unwrap();
        }
        encoder.encode_symbol(&mut model, 0).unwrap();
        encoder.done().unwrap();
        let mut decoder = ArithmeticDecoder::new(Cursor::new(encoder.into_inner()));
        decoder.read_init_bytes().unwrap();
        GpsTimeSkipper::default().decompress_with(&mut decoder, &mut [0; 8])
    }

    #[test]
    fn changes_without_end_are_refused() {
        skip_changes(0).unwrap();
        skip_changes(MAX_CHANGES).unwrap();
        let error = skip_changes(MAX_CHANGES + 1).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::InvalidData);
        assert!(skip_changes(1000).is_err());
    }
}
