//! Enums with a list of their values.

/// Defines an enum with `ALL`, the list of its values in the order in which they are declared, and with `name` if the values have names. Values that
/// have a field are given apart; then the list is `PLAIN`, of those without.
macro_rules! listed {
    ($(#[$about:meta])* $name:ident { $($(#[$doc:meta])* $value:ident,)+ }) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum $name {
            $($(#[$doc])* $value,)+
        }

        impl $name {
            /// All values.
            pub const ALL: [Self; [$(Self::$value),+].len()] = [$(Self::$value),+];
        }
    };
    ($(#[$about:meta])* $name:ident { $($(#[$doc:meta])* $value:ident,)+ } and { $($more:tt)+ }) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum $name {
            $($more)+
            $($(#[$doc])* $value,)+
        }

        impl $name {
            /// All values without a field.
            const PLAIN: [Self; [$(Self::$value),+].len()] = [$(Self::$value),+];
        }
    };
    ($(#[$about:meta])* $name:ident { $($(#[$doc:meta])* $value:ident = $word:literal,)+ }) => {
        $crate::problem::listed::listed! {
            $(#[$about])* $name { $($(#[$doc])* $value,)+ }
        }

        impl $name {
            /// Its name.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$value => $word,)+
                }
            }
        }
    };
}

pub(crate) use listed;
