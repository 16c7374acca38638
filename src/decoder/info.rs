//! What a stream says of itself, without decoding.

use super::frame::StreamInfo;
use super::push::Decoder;
use crate::error::DecodeError;
use crate::limits::Limits;

impl StreamInfo {
    /// Reads what a stream, or its beginning, says of itself; `None` if the table of passes has not
    /// come yet. Nothing is decoded.
    ///
    /// # Errors
    /// If the bytes are no stream, or damaged before the table ends.
    pub fn read(bytes: &[u8]) -> Result<Option<Self>, DecodeError> {
        let limits = Limits { max_work: Some(u64::MAX), ..Limits::default() };
        let mut decoder = Decoder::new(limits);
        decoder.feed(bytes)?;
        decoder.read_info()?;
        Ok(decoder.info().cloned())
    }
}
