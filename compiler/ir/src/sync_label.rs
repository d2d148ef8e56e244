//! What an edge's label says of its part in a transition.

use crate::{
    event::EventId,
    ta::{ChannelId, ReceiveArg, SyncLabel},
};

impl<E> SyncLabel<E> {
    /// The channel that it is a part in.
    #[must_use]
    pub fn channel(&self) -> Option<ChannelId> {
        match self {
            SyncLabel::Internal | SyncLabel::Send { .. } | SyncLabel::Receive { .. } => None,
            SyncLabel::Offer { channel, .. }
            | SyncLabel::Accept { channel, .. }
            | SyncLabel::Join { channel } => Some(*channel),
        }
    }

    /// The event that it sends or takes.
    #[must_use]
    pub fn event(&self) -> Option<EventId> {
        self.as_send().map(|sent| sent.0).or(self.as_receive().map(|taken| taken.0))
    }

    /// The event that it sends, with its arguments.
    #[must_use]
    pub fn as_send(&self) -> Option<(EventId, &[E])> {
        if let SyncLabel::Send { event, args } = self { Some((*event, args)) } else { None }
    }

    /// The event that it takes, and which of them by their arguments.
    #[must_use]
    pub fn as_receive(&self) -> Option<(EventId, &[ReceiveArg])> {
        if let SyncLabel::Receive { event, args } = self { Some((*event, args)) } else { None }
    }

    /// The channel over which it offers, with the arguments.
    #[must_use]
    pub fn as_offer(&self) -> Option<(ChannelId, &[E])> {
        if let SyncLabel::Offer { channel, args } = self { Some((*channel, args)) } else { None }
    }

    /// The channel over which it accepts, and what by the arguments.
    #[must_use]
    pub fn as_accept(&self) -> Option<(ChannelId, &[ReceiveArg])> {
        if let SyncLabel::Accept { channel, args } = self { Some((*channel, args)) } else { None }
    }

    /// The arguments that it hands over.
    #[must_use]
    pub fn given(&self) -> &[E] {
        self.as_send().map(|sent| sent.1).or(self.as_offer().map(|offered| offered.1)).unwrap_or_default()
    }
}
