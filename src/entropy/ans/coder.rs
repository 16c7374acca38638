//! One side of the coder of symbols, over which passes are written once.

use super::token::{fold, unfold};

/// The encoder returns what it was given, the decoder ignores its argument and returns what it read.
pub(crate) trait SymbolCoder {
    /// Codes a symbol of the alphabet of `group` in one of its contexts.
    fn symbol(&mut self, group: usize, context: usize, symbol: u8) -> u8;

    /// Codes a number as a token of the alphabet of `group`, and what is left of it.
    fn number(&mut self, group: usize, context: usize, number: u32) -> u32;

    /// Codes the lowest `count` bits of `value`, up to 32, as they are.
    fn raw(&mut self, value: u32, count: u32) -> u32;

    /// Codes a number with a sign.
    #[inline(always)]
    fn signed(&mut self, group: usize, context: usize, value: i32) -> i32 {
        unfold(self.number(group, context, fold(value)))
    }
}
