//! Settings from files.

/// Writes and reads a type by its name, with its parameter if it has one, through the constructor that checks it: what is
/// written by hand can be wrong. Without names all kernels, and all cones, would look alike.
macro_rules! by_name {
    ($named:ident: $type:ident) => {
        /// As it is in a file.
        #[derive(serde::Serialize, serde::Deserialize)]
        #[serde(rename_all = "snake_case")]
        enum $named {
            $type,
        }

        impl From<$named> for $type {
            fn from($named::$type: $named) -> Self {
                Self
            }
        }

        impl From<$type> for $named {
            fn from(_: $type) -> Self {
                Self::$type
            }
        }
    };
    ($named:ident: $type:ident($kind:ty), $write:expr, $error:ty) => {
        /// As it is in a file.
        #[derive(serde::Serialize, serde::Deserialize)]
        #[serde(rename_all = "snake_case")]
        enum $named {
            $type($kind),
        }

        impl TryFrom<$named> for $type {
            type Error = $error;

            fn try_from($named::$type(parameter): $named) -> Result<Self, $error> {
                Self::new(parameter)
            }
        }

        impl From<$type> for $named {
            fn from(value: $type) -> Self {
                let write: fn($type) -> $kind = $write;
                Self::$type(write(value))
            }
        }
    };
}
