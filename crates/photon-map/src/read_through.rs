//! Settings from files.

/// Reads a type by its fields, through the constructor that checks them: what is written by hand can be wrong.
macro_rules! read_through {
    ($type:ident { $($field:ident: $kind:ty),* } => $make:expr, $error:ty) => {
        /// The fields, before they are checked.
        #[derive(serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        struct Unchecked {
            $($field: $kind),*
        }

        impl TryFrom<Unchecked> for $type {
            type Error = $error;

            fn try_from(Unchecked { $($field),* }: Unchecked) -> Result<Self, Self::Error> {
                $make
            }
        }
    };
}
