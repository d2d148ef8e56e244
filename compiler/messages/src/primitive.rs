//! The types that are made of no others.

use crate::name::RosVersion;

/// A type that holds one value; some are of one version of ROS alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum PrimitiveType {
    Bool,
    Byte,
    Char,
    Int8,
    Uint8,
    Int16,
    Uint16,
    Int32,
    Uint32,
    Int64,
    Uint64,
    Float32,
    Float64,
    String,
    WideString,
    /// ROS 1 alone; in ROS 2 a message of `builtin_interfaces`, as is the next.
    Time,
    Duration,
}

impl PrimitiveType {
    pub const ALL: [Self; 17] = [
        Self::Bool,
        Self::Byte,
        Self::Char,
        Self::Int8,
        Self::Uint8,
        Self::Int16,
        Self::Uint16,
        Self::Int32,
        Self::Uint32,
        Self::Int64,
        Self::Uint64,
        Self::Float32,
        Self::Float64,
        Self::String,
        Self::WideString,
        Self::Time,
        Self::Duration,
    ];

    /// As it is written.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Bool => "bool",
            Self::Byte => "byte",
            Self::Char => "char",
            Self::Int8 => "int8",
            Self::Uint8 => "uint8",
            Self::Int16 => "int16",
            Self::Uint16 => "uint16",
            Self::Int32 => "int32",
            Self::Uint32 => "uint32",
            Self::Int64 => "int64",
            Self::Uint64 => "uint64",
            Self::Float32 => "float32",
            Self::Float64 => "float64",
            Self::String => "string",
            Self::WideString => "wstring",
            Self::Time => "time",
            Self::Duration => "duration",
        }
    }

    /// The type of this word, in either version.
    #[must_use]
    pub fn of_word(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|t| t.word() == word)
    }

    #[must_use]
    pub fn is_in(self, version: RosVersion) -> bool {
        match self {
            Self::WideString => version == RosVersion::Ros2,
            Self::Time | Self::Duration => version == RosVersion::Ros1,
            Self::Bool | Self::Byte | Self::Char | Self::Float32 | Self::Float64 | Self::String => true,
            Self::Int8 | Self::Int16 | Self::Int32 | Self::Int64 => true,
            Self::Uint8 | Self::Uint16 | Self::Uint32 | Self::Uint64 => true,
        }
    }

    #[must_use]
    pub fn is_text(self) -> bool {
        matches!(self, Self::String | Self::WideString)
    }

    /// The least and the greatest number, of whole numbers. ROS 1's `byte` is signed, ROS 2's is not; `char` is a number in both.
    #[must_use]
    pub fn range(self, version: RosVersion) -> Option<(i128, i128)> {
        let signed = |bits: u32| Some((-(1i128 << (bits - 1)), (1i128 << (bits - 1)) - 1));
        let unsigned = |bits: u32| Some((0, (1i128 << bits) - 1));
        match self {
            Self::Byte if version == RosVersion::Ros1 => signed(8),
            Self::Int8 => signed(8),
            Self::Int16 => signed(16),
            Self::Int32 => signed(32),
            Self::Int64 => signed(64),
            Self::Byte | Self::Char | Self::Uint8 => unsigned(8),
            Self::Uint16 => unsigned(16),
            Self::Uint32 => unsigned(32),
            Self::Uint64 => unsigned(64),
            Self::Bool | Self::Float32 | Self::Float64 | Self::String | Self::WideString => None,
            Self::Time | Self::Duration => None,
        }
    }
}
