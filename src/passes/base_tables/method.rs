//! How the base mesh of the profile *fast* is coded: the first byte of its payload.

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BaseMethod {
    /// As in the other profiles.
    Mixed = 0,
    /// In tables.
    Tables = 1,
}

impl BaseMethod {
    pub(crate) fn of(payload: &[u8]) -> Option<Self> {
        match payload.first()? {
            0 => Some(Self::Mixed),
            1 => Some(Self::Tables),
            _ => None,
        }
    }
}
