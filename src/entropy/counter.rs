//! Probabilities that follow the bits they see (`format/SPEC.md`, section 6.3).

/// Probability of a one in one context: 22 bits of probability, 10 bits of age.
#[derive(Clone, Copy)]
pub(crate) struct Counter(u32);

impl Counter {
    const AGE_BITS: u32 = 10;
    const AGE_MASK: u32 = (1 << Self::AGE_BITS) - 1;

    pub(crate) const fn new() -> Self {
        Self::aged(1 << 15, 0)
    }

    /// With the probability `p16` in 1/65536 as if it had learnt it from `age` bits.
    pub(super) const fn aged(p16: u32, age: u32) -> Self {
        Self(p16 << 16 | age)
    }

    /// Probability of a one in 1/4096.
    #[inline]
    pub(super) fn p12(self) -> usize {
        (self.0 >> 20) as usize
    }

    /// Probability of a one in 1/65536.
    #[inline]
    pub(super) fn p16(self) -> u32 {
        self.0 >> 16
    }

    #[inline]
    pub(super) fn age(self) -> u32 {
        self.0 & Self::AGE_MASK
    }

    /// Moves towards `bit` by 1/(age + 1.5), the age growing up to `limit`.
    #[inline(always)]
    pub(super) fn update(&mut self, bit: bool, limit: u32) {
        let age = self.age();
        // Upside down for a one, so that both bits go the same way.
        let flip = if bit { u32::MAX >> Self::AGE_BITS } else { 0 };
        let p = (self.0 >> Self::AGE_BITS) ^ flip;
        let p = p - ((u64::from(p) * u64::from(RECIPROCALS[age as usize])) >> 16) as u32;
        self.0 = (p ^ flip) << Self::AGE_BITS | (age + u32::from(age < limit));
    }
}

const fn reciprocals() -> [u32; 1024] {
    let mut table = [0; 1024];
    let mut age = 0;
    while age < 1024 {
        // 65536 / (age + 1.5), rounded down.
        table[age] = (2 * 65_536 / (2 * age + 3)) as u32;
        age += 1;
    }
    table
}

static RECIPROCALS: [u32; 1024] = reciprocals();
