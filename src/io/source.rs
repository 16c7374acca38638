//! The bytes of a file in pieces, so that a parser needs no more memory than what it keeps.

use super::ReadError;
use std::io::Read;

/// Bytes read at a time.
const PIECE_BYTES: usize = 1 << 16;

/// What is left of a file.
///
/// A parser sees the end of the file where reading fails; [`Source::finish`] returns what it was. That is
/// worth more than whatever the parser makes of the end, so it comes first.
pub(super) struct Source<'a> {
    reader: Box<dyn Read + 'a>,
    /// All bytes of the file, where they are known before they are read.
    num_bytes: Option<u64>,
    buffer: Vec<u8>,
    /// What comes next of the buffer.
    start: usize,
    /// Bytes of the file in front of the buffer.
    num_before: usize,
    num_lines: usize,
    is_at_end: bool,
    failure: Option<ReadError>,
}

/// A line of a text that need not be UTF-8.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Line<'a> {
    /// From 1.
    pub number: usize,
    /// Without its end, which is LF, CR LF or CR alone.
    pub text: &'a [u8],
    /// The last line, if nothing ends it but the end of the file.
    pub is_cut: bool,
}

impl<'a> Source<'a> {
    /// `num_bytes`: of the whole file, if that is known.
    pub fn new(reader: impl Read + 'a, num_bytes: Option<u64>) -> Self {
        Self {
            reader: Box::new(reader),
            num_bytes,
            buffer: Vec::new(),
            start: 0,
            num_before: 0,
            num_lines: 0,
            is_at_end: false,
            failure: None,
        }
    }

    /// A file in memory.
    pub fn of_bytes(bytes: &'a [u8]) -> Self {
        Self::new(bytes, Some(bytes.len() as u64))
    }

    /// Bytes of the whole file, if that is known before its end.
    pub fn num_bytes(&self) -> Option<u64> {
        self.num_bytes
    }

    /// Bytes that were taken so far.
    pub fn offset(&self) -> usize {
        self.num_before + self.start
    }

    /// How many elements of at least `min_bytes` the rest has room for: 0 if nobody knows.
    pub fn room_for(&self, min_bytes: usize) -> usize {
        let num_left = self.num_bytes.unwrap_or(0).saturating_sub(self.offset() as u64);
        usize::try_from(num_left).unwrap_or(usize::MAX) / min_bytes
    }

    /// The number of the line last taken, 0 before the first.
    pub fn num_lines(&self) -> usize {
        self.num_lines
    }

    /// The next bytes, at most `most`, which are not taken.
    pub fn peek(&mut self, most: usize) -> &[u8] {
        self.fill(most);
        let end = self.buffer.len().min(self.start + most);
        &self.buffer[self.start..end]
    }

    /// Takes the next `num` bytes; nothing if there are fewer.
    pub fn take(&mut self, num: usize) -> Option<&[u8]> {
        if !self.fill(num) {
            return None;
        }
        self.start += num;
        Some(&self.buffer[self.start - num..self.start])
    }

    /// Passes over `num` bytes, or all if there are fewer. Returns how many there were.
    pub fn skip(&mut self, num: u64) -> u64 {
        let mut num_left = num;
        while num_left > 0 && self.fill(1) {
            let step = num_left.min((self.buffer.len() - self.start) as u64);
            self.start += step as usize;
            num_left -= step;
        }
        num - num_left
    }

    /// Passes over lines without anything: of these a compressed file may have more than of all else.
    pub fn skip_empty_lines(&mut self) {
        while self.fill(1) {
            let rest = &self.buffer[self.start..];
            let num = rest.iter().position(|&byte| byte != b'\n').unwrap_or(rest.len());
            self.start += num;
            self.num_lines += num;
            if self.start < self.buffer.len() {
                break;
            }
        }
    }

    /// Takes the next line.
    pub fn line(&mut self) -> Option<Line<'_>> {
        let is_end = |&byte: &u8| byte == b'\n' || byte == b'\r';
        let mut length = 0;
        loop {
            let rest = &self.buffer[self.start + length..];
            let found = rest.iter().position(is_end);
            length += found.unwrap_or(rest.len());
            if found.is_some() || !self.fill(length + 1) {
                break;
            }
        }
        let end_bytes = match self.peek(length + 2)[length..] {
            [b'\r', b'\n'] => 2,
            [_, ..] => 1,
            [] if length == 0 => return None,
            [] => 0,
        };
        let text = self.start..self.start + length;
        self.start = text.end + end_bytes;
        self.num_lines += 1;
        Some(Line { number: self.num_lines, text: &self.buffer[text], is_cut: end_bytes == 0 })
    }

    /// The whole rest.
    ///
    /// # Errors
    /// If it cannot be read, or memory is short.
    #[cfg(any(feature = "gltf", feature = "las", test))]
    pub fn into_bytes(mut self) -> Result<Vec<u8>, ReadError> {
        let room = self.room_for(1);
        self.buffer.try_reserve_exact(room).map_err(std::io::Error::other)?;
        while self.read_more() {}
        self.buffer.drain(..self.start);
        self.failure.map_or(Ok(self.buffer), Err)
    }

    /// Reads the rest, which may be damaged where nobody looked.
    ///
    /// # Errors
    /// What went wrong with reading, now or before.
    pub fn finish(mut self) -> Result<(), ReadError> {
        self.skip(u64::MAX);
        self.failure.map_or(Ok(()), Err)
    }

    /// Whether there are `num` bytes to come; they are in the buffer then.
    fn fill(&mut self, num: usize) -> bool {
        while self.buffer.len() - self.start < num {
            self.num_before += self.start;
            self.buffer.drain(..self.start);
            self.start = 0;
            if !self.read_more() {
                return false;
            }
        }
        true
    }

    /// Appends a piece to the buffer.
    fn read_more(&mut self) -> bool {
        if self.is_at_end {
            return false;
        }
        let held = self.buffer.len();
        let piece = self.reader.by_ref().take(PIECE_BYTES as u64).read_to_end(&mut self.buffer);
        self.is_at_end = !matches!(piece, Ok(1..));
        // The unpacker has its own reason.
        self.failure = piece.err().map(|error| error.downcast().unwrap_or_else(ReadError::Io));
        self.buffer.len() > held
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gives one byte at a time, then fails.
    struct Slow<'a>(&'a [u8]);

    impl Read for Slow<'_> {
        fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
            match self.0.split_first() {
                Some((byte, rest)) => {
                    buffer[0] = *byte;
                    self.0 = rest;
                    Ok(1)
                }
                None => Err(std::io::Error::other("torn")),
            }
        }
    }

    fn lines(text: &[u8]) -> Vec<(usize, Vec<u8>, bool)> {
        let mut source = Source::of_bytes(text);
        let mut lines = Vec::new();
        while let Some(line) = source.line() {
            lines.push((line.number, line.text.to_vec(), line.is_cut));
        }
        lines
    }

    #[test]
    fn lines_end_in_any_way() {
        let expected = [
            (1, "a", false),
            (2, "b", false),
            (3, "", false),
            (4, "d", false),
            (5, "", false),
            (6, "e", true),
        ];
        let expected = expected.map(|(number, text, is_cut)| (number, text.as_bytes().to_vec(), is_cut));
        assert_eq!(lines(b"a\nb\r\n\rd\n\ne"), expected);
        assert_eq!(lines(b""), []);
        assert_eq!(lines(b"\n"), [(1, Vec::new(), false)]);
    }

    #[test]
    fn lines_end_in_any_way_between_two_pieces() {
        for length in PIECE_BYTES - 3..PIECE_BYTES + 3 {
            let long = vec![b'x'; length];
            let text = [&long[..], b"\r\ny\n\rz\r"].concat();
            let expected = [long, b"y".to_vec(), Vec::new(), b"z".to_vec()];
            assert_eq!(lines(&text).into_iter().map(|(_, text, _)| text).collect::<Vec<_>>(), expected);
        }
    }

    #[test]
    fn empty_lines_are_counted_where_they_are_skipped() {
        let text = [&b"a\r\n"[..], &vec![b'\n'; 2 * PIECE_BYTES], b"\r\nb"].concat();
        let mut source = Source::of_bytes(&text);
        assert_eq!(source.line().map(|line| line.text), Some(&b"a"[..]));
        source.skip_empty_lines();
        assert_eq!(source.num_lines(), 1 + 2 * PIECE_BYTES);
        assert_eq!(source.line().map(|line| line.text), Some(&b""[..]));
        source.skip_empty_lines();
        let line = Line { number: 3 + 2 * PIECE_BYTES, text: b"b", is_cut: true };
        assert_eq!(source.line(), Some(line));
        source.skip_empty_lines();
        assert_eq!(source.line(), None);
    }

    #[test]
    fn bytes_are_taken_whole_or_not_at_all() {
        let bytes: Vec<u8> = (0..=255).cycle().take(3 * PIECE_BYTES).collect();
        let mut source = Source::of_bytes(&bytes);
        assert_eq!(source.peek(2), [0, 1]);
        assert_eq!(source.take(PIECE_BYTES + 1), Some(&bytes[..PIECE_BYTES + 1]));
        assert_eq!(source.skip(5), 5);
        assert_eq!(source.take(2), Some(&[6, 7][..]));
        assert_eq!((source.offset(), source.room_for(10)), (PIECE_BYTES + 8, (2 * PIECE_BYTES - 8) / 10));
        assert_eq!(source.take(2 * PIECE_BYTES), None);
        assert_eq!(source.offset(), PIECE_BYTES + 8);
        assert_eq!(source.skip(u64::MAX), 2 * PIECE_BYTES as u64 - 8);
        assert!(source.peek(1).is_empty() && source.finish().is_ok());
    }

    #[test]
    fn a_failure_is_the_end_of_the_file_and_is_told_last() {
        let mut source = Source::new(Slow(b"one\ntw"), None);
        assert_eq!(source.line().map(|line| line.text), Some(&b"one"[..]));
        assert_eq!(source.line().map(|line| line.text), Some(&b"tw"[..]));
        assert!(source.line().is_none() && source.take(1).is_none());
        assert_eq!(source.finish().unwrap_err().to_string(), "torn");
        assert_eq!(Source::new(Slow(b"three"), None).into_bytes().unwrap_err().to_string(), "torn");
    }
}
