//! How much of a file has been read.

use std::io::{self, Read};

/// Counts the bytes of a file as they are read, and tells which share of them that is.
pub(super) struct Counter<'a> {
    file: Box<dyn Read + 'a>,
    pub num_bytes: u64,
    /// Of the whole file, if that is known.
    total: Option<u64>,
    progress: &'a dyn Fn(f64),
    /// What `progress` hears at the end of the file.
    share: f64,
}

impl<'a> Counter<'a> {
    /// `total`: bytes of the file. `share`: that of its bytes in the work of reading it.
    pub fn new(file: Box<dyn Read + 'a>, total: Option<u64>, share: f64, progress: &'a dyn Fn(f64)) -> Self {
        Self { file, num_bytes: 0, total, progress, share }
    }
}

impl Read for Counter<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let num_read = self.file.read(buffer)?;
        self.num_bytes += num_read as u64;
        if let Some(total) = self.total {
            // A file may grow while it is read.
            let done = self.num_bytes as f64 / total.max(1) as f64;
            (self.progress)(done.min(1.0) * self.share);
        }
        Ok(num_read)
    }
}
