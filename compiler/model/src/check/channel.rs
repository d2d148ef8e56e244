//! Channels: their declarations, and what an edge does over one.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, Call, ItemKind, Name};

use super::{
    Checker, Env,
    automaton::Scope,
    layout::{Fields, type_span},
    table::Table,
};
use crate::{
    Channel, ChannelId, ChannelKind, ChannelPlaces, EventId, Expr, Party, PlayerRef, Sync,
    noun::Noun,
    report::{automata, names::duplicate},
    types::finite_var,
};

/// What an edge takes or gives.
pub(super) enum Medium {
    Event(EventId),
    Channel(ChannelId),
}

impl Checker<'_> {
    /// After the automata have their names: those are the parties of joint channels.
    pub(super) fn declare_channels(&mut self) {
        for (item, span) in self.each_item() {
            if let ItemKind::Channel(channel) = item {
                self.declare_channel(channel, span);
            }
        }
    }

    fn declare_channel(&mut self, channel: &ast::Channel, whole: Span) {
        for one in &channel.names {
            let name = &one.name;
            let fields = self.channel_params(&one.params);
            let mut parties = Vec::new();
            let kind = match &channel.kind {
                ast::ChannelKind::HandShake => ChannelKind::HandShake,
                ast::ChannelKind::Broadcast => ChannelKind::Broadcast,
                ast::ChannelKind::Joint(of) => {
                    if let Some(param) = one.params.first() {
                        self.report(automata::joint_params(&name.text, param.name.span));
                    }
                    ChannelKind::Joint(self.parties(name, of, &mut parties))
                }
            };
            if let Some(event) = self.events.get(&name.text) {
                let noun = self.noun_of(EventId(event));
                self.report(duplicate(noun, &name.text, name.span, self.events.span(event)));
                continue;
            }
            if Self::declare(&mut self.issues, &mut self.channels, Noun::Channel, name).is_none() {
                continue;
            }
            let params = self.flat(&fields).iter().map(|p| finite_var(&p.name, p.ty)).collect();
            self.channel_fields.push(fields);
            let span = if channel.names.len() == 1 { whole } else { name.span };
            let (text, urgent) = (name.text.clone(), channel.urgent);
            self.s.channels.push(Channel { name: text, kind, urgent, params, origin: span });
            self.s.places.channels.push(ChannelPlaces { name: name.span, parties });
        }
    }

    /// Parameters of finite types.
    fn channel_params(&mut self, params: &[ast::Param]) -> Fields {
        let fields = self.fields(params);
        for (param, (_, layout)) in params.iter().zip(fields.iter()) {
            if self.plain(layout, &param.name.text, type_span(&param.ty)) {
                self.finite_layout(layout, "a parameter of a channel", param.name.span);
            }
        }
        fields
    }

    /// The automata of a joint channel; `places` gets where they are named.
    fn parties(&mut self, channel: &Name, parties: &[ast::Party], places: &mut Vec<Span>) -> Vec<Party> {
        let (mut resolved, mut seen) = (Vec::new(), Table::default());
        for party in parties {
            let name = &party.automaton;
            let player = self.players.get(&name.text).map(|id| self.player_ids[usize::from(id)]);
            let Some(PlayerRef::Automaton(automaton)) = player else {
                let all: Vec<String> = self.s.automata.iter().map(|a| a.name.clone()).collect();
                self.unknown(Noun::Automaton, name, &all, None);
                self.vague_channels.insert(channel.text.clone());
                continue;
            };
            self.refer(name, self.players.span_of(&name.text));
            if Self::declare(&mut self.issues, &mut seen, Noun::Automaton, name).is_some() {
                resolved.push(Party { automaton, optional: party.optional });
                places.push(name.span);
            }
        }
        resolved
    }

    /// What `on` or `do` of an edge names.
    pub(super) fn medium(&mut self, scope: &Scope, name: &Name, local: Option<Noun>) -> Option<Medium> {
        let given = self.given(&name.text).is_some();
        if let Some(id) = self.channels.get(&name.text).filter(|_| !given) {
            self.refer(name, self.channels.span(id));
            return Some(Medium::Channel(ChannelId(id)));
        }
        let known = given || self.events.get(&name.text).is_some();
        if !known && (scope.actor.is_none() || self.channels.names().next().is_some()) {
            let mut names = self.near(self.channels.names());
            if scope.actor.is_some() {
                names.extend(self.near(self.events.names()));
                names.extend(self.given_names(Noun::Event));
            }
            let noun = if scope.actor.is_some() { Noun::Medium } else { Noun::Channel };
            self.unknown(noun, name, &names, local);
            return None;
        }
        let event = self.event(Noun::EventOrStimulus, name, local)?;
        if scope.actor.is_none() {
            let noun = self.noun_of(event);
            let automaton = &self.s.automata[scope.index].name;
            self.report(automata::no_actor(automaton, noun, &name.text, name.span));
            return None;
        }
        Some(Medium::Event(event))
    }

    /// `on c(…)`
    pub(super) fn accept(
        &mut self,
        scope: &Scope,
        channel: ChannelId,
        call: &Call,
        env: &mut Env,
        equal: &mut Vec<Expr>,
    ) -> Option<Sync> {
        let fields = self.fields_of_channel(channel);
        if !self.is_joint(channel) {
            let args = self.received_args(Noun::Channel, call, &fields, env, equal)?;
            return Some(Sync::Accept { channel, args });
        }
        if call.args.as_ref().is_some_and(|args| !args.is_empty()) {
            self.wrong_arity(Noun::Channel, call, &fields);
        }
        // A template is no party, but its instances may be.
        let vague = self.by_itself || self.vague_channels.contains(&call.name.text);
        let of = &self.s.channels[usize::from(channel.0)];
        let party = match &of.kind {
            ChannelKind::Joint(parties) => parties.iter().any(|p| usize::from(p.automaton.0) == scope.index),
            ChannelKind::HandShake | ChannelKind::Broadcast => true,
        };
        if !party && !vague {
            let place = self.s.places.channels[usize::from(channel.0)].name;
            let automaton = &self.s.automata[scope.index].name;
            self.report(automata::not_a_party(automaton, &of.name, call.name.span, place));
        }
        Some(Sync::Join { channel })
    }

    /// `do c(…)`
    pub(super) fn offer(&mut self, channel: ChannelId, call: &Call, env: &mut Env) -> Option<Sync> {
        if self.is_joint(channel) {
            self.report(automata::joint_offered(&call.name.text, call.span));
            return None;
        }
        let fields = self.fields_of_channel(channel);
        let args = self.args(Noun::Channel, call, &fields, env);
        let params = self.s.channels[usize::from(channel.0)].params.len();
        (args.len() == params).then_some(Sync::Offer { channel, args })
    }

    /// The edges of an urgent channel have no clock guards, but those that accept a broadcast.
    pub(super) fn check_urgent(&mut self, sync: &Sync, clock_guard: Option<Span>) {
        let Some((channel, span)) = sync.channel().zip(clock_guard) else { return };
        let place = self.s.places.channels[usize::from(channel.0)].name;
        let channel = &self.s.channels[usize::from(channel.0)];
        let hears = matches!(sync, Sync::Accept { .. }) && channel.kind == ChannelKind::Broadcast;
        if channel.urgent && !hears {
            self.report(automata::urgent_guard(&channel.name, span, place));
        }
    }

    fn is_joint(&self, channel: ChannelId) -> bool {
        matches!(self.s.channels[usize::from(channel.0)].kind, ChannelKind::Joint(_))
    }

    fn fields_of_channel(&self, channel: ChannelId) -> Fields {
        self.channel_fields[usize::from(channel.0)].clone()
    }
}
