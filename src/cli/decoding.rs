//! A decoder that tells how far it is.

use super::bar::Part;
use lwc::{DecodeError, DecodeOptions, Decoder, PassInfo, Step};

/// Units of work between two reports: some hundredths of a second.
const SLICE: u32 = 1 << 17;

/// A decoder, and what of its bytes it has to go through.
pub struct Decoding<'a> {
    pub decoder: Decoder,
    level: Option<u32>,
    most_bytes: Option<u64>,
    part: Part<'a>,
    /// Passes that were done when the work was looked at, and the work up to there.
    passes: usize,
    work: u64,
}

impl<'a> Decoding<'a> {
    /// `level` is the one that `options` stop at, `most_bytes` will come at most.
    pub fn new(options: DecodeOptions, level: Option<u32>, most_bytes: Option<u64>, part: Part<'a>) -> Self {
        Self { decoder: Decoder::with_options(options), level, most_bytes, part, passes: 0, work: 0 }
    }

    /// Decodes what these bytes complete, and tells `see` of each pass.
    ///
    /// # Errors
    /// If the stream is damaged or beyond the limits.
    pub fn take(&mut self, bytes: &[u8], mut see: impl FnMut(&PassInfo)) -> Result<(), DecodeError> {
        self.decoder.feed(bytes)?;
        loop {
            let step = self.decoder.step_within(SLICE)?;
            self.tell();
            match step {
                Step::Finished(update) => see(&update.pass),
                Step::Unfinished => {}
                Step::Waiting => return Ok(()),
            }
        }
    }

    /// Bytes tell how far it is, and work how far within a pass.
    fn tell(&mut self) {
        let Some(info) = self.decoder.info() else { return };
        let (passes, total) = (info.passes(), info.total_bytes().max(1));
        if self.decoder.passes_done() != self.passes {
            (self.passes, self.work) = (self.decoder.passes_done(), self.decoder.work_done());
        }
        let end_of = |pass: usize| passes.get(pass).map_or(total, |pass| pass.end);
        let begin = if self.passes > 0 { end_of(self.passes - 1) } else { 0 };
        let bytes = end_of(self.passes).saturating_sub(begin) as f64;
        let work = info.work() as f64 * bytes / total as f64;
        let within = (self.decoder.work_done() - self.work) as f64 / work.max(1.0);
        let is_wanted = |pass: &&PassInfo| self.level.is_some_and(|level| pass.level <= level);
        let last = passes.iter().take_while(is_wanted).last();
        let wanted = last.map_or(total, |last| last.end).min(self.most_bytes.unwrap_or(u64::MAX)).max(1);
        self.part.set((begin as f64 + bytes * within.min(1.0)) / wanted as f64);
    }
}
