//! gzip: one member after another, and zeros behind the last, with which tapes and some programs fill blocks.

use flate2::bufread::GzDecoder;
use std::io::{self, BufRead, BufReader, Read};

/// Unpacks the members of a file, one after another.
pub(super) struct Members<R> {
    /// `None` in an unfinished step and at the end.
    member: Option<GzDecoder<BufReader<R>>>,
    /// What follows a member.
    rest: Option<BufReader<R>>,
}

impl<R: Read> Members<R> {
    pub fn new(file: R) -> Self {
        Self { member: Some(GzDecoder::new(BufReader::new(file))), rest: None }
    }

    /// The file.
    pub fn get_ref(&self) -> Option<&R> {
        let reader = self.member.as_ref().map(GzDecoder::get_ref).or(self.rest.as_ref());
        reader.map(BufReader::get_ref)
    }

    /// Goes to the next member, if there is one.
    fn next(&mut self) -> io::Result<bool> {
        if let Some(member) = self.member.take() {
            self.rest = Some(member.into_inner());
        }
        let Some(rest) = &mut self.rest else { return Ok(false) };
        if !skip_zeros(rest)? {
            return Ok(false);
        }
        self.member = self.rest.take().map(GzDecoder::new);
        Ok(true)
    }
}

impl<R: Read> Read for Members<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if buffer.is_empty() {
            return Ok(0);
        }
        loop {
            if let Some(member) = &mut self.member {
                let num_read = member.read(buffer)?;
                if num_read > 0 {
                    return Ok(num_read);
                }
            }
            if !self.next()? {
                return Ok(0);
            }
        }
    }
}

/// Whether anything else follows.
fn skip_zeros(reader: &mut impl BufRead) -> io::Result<bool> {
    loop {
        let bytes = reader.fill_buf()?;
        if bytes.is_empty() {
            return Ok(false);
        }
        let num_zeros = bytes.iter().take_while(|&&byte| byte == 0).count();
        let is_more = num_zeros < bytes.len();
        reader.consume(num_zeros);
        if is_more {
            return Ok(true);
        }
    }
}
