//! Plain integers are numbers without fractional bits.

use super::{Number, sealed::Sealed};

impl Sealed for i8 {}
impl Sealed for i16 {}

impl Number for i32 {
    type Word = i32;
    const FRACTION_BITS: u32 = 0;

    #[inline(always)]
    fn to_word(self) -> i32 {
        self
    }

    #[inline(always)]
    fn from_word(word: i32) -> i32 {
        word
    }
}

impl Number for i16 {
    type Word = i32;
    const FRACTION_BITS: u32 = 0;

    #[inline(always)]
    fn to_word(self) -> i32 {
        self.into()
    }

    #[inline(always)]
    fn from_word(word: i32) -> i16 {
        word.clamp(i16::MIN.into(), i16::MAX.into()) as i16
    }
}

impl Number for i8 {
    type Word = i32;
    const FRACTION_BITS: u32 = 0;

    #[inline(always)]
    fn to_word(self) -> i32 {
        self.into()
    }

    #[inline(always)]
    fn from_word(word: i32) -> i8 {
        word.clamp(i8::MIN.into(), i8::MAX.into()) as i8
    }
}
