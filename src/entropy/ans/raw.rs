//! Bits as they are, the lowest of each byte first.

/// Reads bits from the front of a slice that is handed in each time.
#[derive(Clone, Copy, Default)]
pub(super) struct RawReader {
    next: usize,
    window: u64,
    count: u32,
    /// True if more bits were read than there are.
    pub(super) is_exhausted: bool,
}

impl RawReader {
    /// Reads up to 32 bits.
    #[inline(always)]
    pub(super) fn read(&mut self, bytes: &[u8], count: u32) -> u32 {
        if self.count < count {
            self.refill(bytes);
        }
        let value = (self.window & ((1 << count) - 1)) as u32;
        self.window >>= count;
        self.is_exhausted |= self.count < count;
        self.count = self.count.saturating_sub(count);
        value
    }

    fn refill(&mut self, bytes: &[u8]) {
        while self.count <= 56 && self.next < bytes.len() {
            self.window |= u64::from(bytes[self.next]) << self.count;
            self.next += 1;
            self.count += 8;
        }
    }

    /// True if nothing but zeros is left.
    pub(super) fn is_at_end(&self, bytes: &[u8]) -> bool {
        !self.is_exhausted && self.window == 0 && bytes[self.next..].iter().all(|&b| b == 0)
    }
}

/// Writes what [`RawReader`] reads.
#[cfg(any(feature = "encoder", test))]
#[derive(Clone, Default)]
pub(super) struct RawWriter {
    bytes: Vec<u8>,
    window: u64,
    count: u32,
}

#[cfg(any(feature = "encoder", test))]
impl RawWriter {
    /// Writes up to 32 bits, the lowest of `value`.
    pub(super) fn write(&mut self, value: u32, count: u32) {
        self.window |= u64::from(value) << self.count;
        self.count += count;
        while self.count >= 8 {
            self.bytes.push(self.window as u8);
            self.window >>= 8;
            self.count -= 8;
        }
    }

    pub(super) fn finish(mut self) -> Vec<u8> {
        if self.count > 0 {
            self.bytes.push(self.window as u8);
        }
        self.bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_return() {
        let mut writer = RawWriter::default();
        let numbers: Vec<(u32, u32)> =
            (0..500).map(|i: u32| (i.wrapping_mul(2_654_435_761), i % 33)).collect();
        let cut = |(value, count): (u32, u32)| if count == 32 { value } else { value & ((1 << count) - 1) };
        numbers.iter().for_each(|&n| writer.write(cut(n), n.1));
        let bytes = writer.finish();
        let mut reader = RawReader::default();
        for &n in &numbers {
            assert_eq!(reader.read(&bytes, n.1), cut(n));
        }
        assert!(reader.is_at_end(&bytes) && !reader.is_exhausted);
        reader.read(&bytes, 9);
        assert!(reader.is_exhausted && !reader.is_at_end(&bytes));
    }
}
