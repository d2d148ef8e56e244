//! The container: MCAP (version 0 of its specification), as far as recordings need it. Messages lie in compressed chunks; there are no indices, which
//! would be larger than what they lead to, so that readers go from the beginning to the end.

use std::collections::BTreeMap;

use thiserror::Error;

/// What a file begins and ends with.
pub(crate) const MAGIC: &[u8] = b"\x89MCAP0\r\n";
/// So large a chunk is before it is compressed: if a file is cut, whole chunks can still be read.
const CHUNK: usize = 256 * 1024;
/// No chunk of ours is larger than this when it is unpacked, nor is one of a file that is read.
const MOST_UNPACKED: u64 = 256 << 20;
/// Of zstd: what is behind it takes much longer than it saves.
const LEVEL: i32 = 6;

mod op {
    pub const HEADER: u8 = 0x01;
    pub const FOOTER: u8 = 0x02;
    pub const SCHEMA: u8 = 0x03;
    pub const CHANNEL: u8 = 0x04;
    pub const MESSAGE: u8 = 0x05;
    pub const CHUNK: u8 = 0x06;
    pub const STATISTICS: u8 = 0x0b;
    pub const DATA_END: u8 = 0x0f;
}

/// A message with the topic of its channel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ContainedMessage {
    pub topic: String,
    pub sequence: u32,
    /// Nanoseconds.
    pub time: u64,
    pub data: Vec<u8>,
}

/// Writes a file into memory.
#[derive(Default)]
pub(crate) struct ContainerWriter {
    file: Vec<u8>,
    chunk: Vec<u8>,
    /// The first and the last time in the chunk, and in the file.
    chunk_times: Option<(u64, u64)>,
    times: Option<(u64, u64)>,
    chunks: u32,
    counts: BTreeMap<u16, u64>,
}

impl ContainerWriter {
    pub fn new(library: &str) -> Self {
        let mut writer = Self { file: MAGIC.to_vec(), ..Self::default() };
        let header = RecordBody::default().text("").text(library);
        header.put(op::HEADER, &mut writer.file);
        writer
    }

    /// Opens a channel of messages in JSON, with the schema of them.
    pub fn channel(&mut self, topic: &str, schema_name: &str, schema: &str) -> u16 {
        // No schema has the number 0.
        let number = u16::try_from(self.counts.len() + 1).unwrap_or(u16::MAX);
        let described = RecordBody::default().u16(number).text(schema_name).text("jsonschema").text(schema);
        described.put(op::SCHEMA, &mut self.chunk);
        let channel = RecordBody::default().u16(number).u16(number).text(topic).text("json").u32(0);
        channel.put(op::CHANNEL, &mut self.chunk);
        self.counts.insert(number, 0);
        number
    }

    pub fn message(&mut self, channel: u16, sequence: u32, time: u64, data: &[u8]) -> std::io::Result<()> {
        let body = RecordBody::default().u16(channel).u32(sequence).u64(time).u64(time);
        body.bytes(data).put(op::MESSAGE, &mut self.chunk);
        *self.counts.entry(channel).or_default() += 1;
        let widened = |times: Option<(u64, u64)>| {
            let (first, last) = times.unwrap_or((time, time));
            Some((first.min(time), last.max(time)))
        };
        self.chunk_times = widened(self.chunk_times);
        self.times = widened(self.times);
        if self.chunk.len() >= CHUNK { self.close_chunk() } else { Ok(()) }
    }

    /// What comes next lies in a chunk of its own.
    pub fn close_chunk(&mut self) -> std::io::Result<()> {
        let records = std::mem::take(&mut self.chunk);
        if records.is_empty() {
            return Ok(());
        }
        let packed = zstd::bulk::compress(&records, LEVEL)?;
        let (first, last) = self.chunk_times.take().unwrap_or_default();
        let body = RecordBody::default().u64(first).u64(last).u64(records.len() as u64);
        let body = body.u32(crc32fast::hash(&records)).text("zstd").u64(packed.len() as u64);
        body.bytes(&packed).put(op::CHUNK, &mut self.file);
        self.chunks += 1;
        Ok(())
    }

    pub fn finish(mut self) -> std::io::Result<Vec<u8>> {
        self.close_chunk()?;
        let sum = crc32fast::hash(&self.file);
        RecordBody::default().u32(sum).put(op::DATA_END, &mut self.file);
        let summary = self.file.len();
        self.statistics().put(op::STATISTICS, &mut self.file);
        // The sum of the summary takes in the footer up to it.
        let mut checked = self.file.get(summary..).unwrap_or_default().to_vec();
        let footer = RecordBody::default().u64(summary as u64).u64(0);
        checked.push(op::FOOTER);
        checked.extend_from_slice(&20_u64.to_le_bytes());
        checked.extend_from_slice(&footer.0);
        footer.u32(crc32fast::hash(&checked)).put(op::FOOTER, &mut self.file);
        self.file.extend_from_slice(MAGIC);
        Ok(self.file)
    }

    fn statistics(&self) -> RecordBody {
        let kinds = self.counts.len();
        let (first, last) = self.times.unwrap_or_default();
        let schemas = u16::try_from(kinds).unwrap_or(u16::MAX);
        let body = RecordBody::default().u64(self.counts.values().sum()).u16(schemas);
        let body = body.u32(u32::from(schemas)).u32(0).u32(0).u32(self.chunks).u64(first).u64(last);
        let body = body.u32(10 * u32::from(schemas));
        self.counts.iter().fold(body, |body, (channel, count)| body.u16(*channel).u64(*count))
    }
}

/// What a record consists of, in little-endian order.
#[derive(Default)]
struct RecordBody(Vec<u8>);

impl RecordBody {
    fn bytes(mut self, bytes: &[u8]) -> Self {
        self.0.extend_from_slice(bytes);
        self
    }

    fn u16(self, n: u16) -> Self {
        self.bytes(&n.to_le_bytes())
    }

    fn u32(self, n: u32) -> Self {
        self.bytes(&n.to_le_bytes())
    }

    fn u64(self, n: u64) -> Self {
        self.bytes(&n.to_le_bytes())
    }

    fn text(self, text: &str) -> Self {
        self.u32(u32::try_from(text.len()).unwrap_or(u32::MAX)).bytes(text.as_bytes())
    }

    fn put(&self, op: u8, to: &mut Vec<u8>) {
        to.push(op);
        to.extend_from_slice(&(self.0.len() as u64).to_le_bytes());
        to.extend_from_slice(&self.0);
    }
}

/// Why a file cannot be read on.
#[derive(Debug, Error, PartialEq, Eq)]
pub(crate) enum ContainerError {
    #[error("this is no MCAP file")]
    NotMcap,
    #[error("the file is cut off after {0} bytes, in the middle of a record")]
    Cut(usize),
    #[error("the file is cut off: it has no end")]
    Endless,
    #[error("a chunk is packed as `{0}`, which hrdsl does not read; `mcap compress` packs it as zstd")]
    Packing(String),
    #[error("a chunk cannot be unpacked: {0}")]
    Unpack(String),
    #[error("a chunk is damaged: its checksum is another one")]
    Checksum,
}

/// Reads a file in order, and gives each message. What was read before an error has been given.
pub(crate) fn read(file: &[u8], give: &mut dyn FnMut(ContainedMessage)) -> Result<(), ContainerError> {
    let rest = file.strip_prefix(MAGIC).ok_or(ContainerError::NotMcap)?;
    let mut topics = BTreeMap::new();
    let mut fields = Fields(rest);
    while !fields.0.is_empty() {
        let at = file.len() - fields.0.len();
        let (op, body) = fields.record().ok_or(ContainerError::Cut(at))?;
        match op {
            op::DATA_END | op::FOOTER => return Ok(()),
            op::CHUNK => {
                let records = unpacked(body).ok_or(ContainerError::Cut(at))??;
                let mut inside = Fields(&records);
                while !inside.0.is_empty() {
                    let (op, body) = inside.record().ok_or(ContainerError::Cut(at))?;
                    take(op, body, &mut topics, give);
                }
            }
            _ => take(op, body, &mut topics, give),
        }
    }
    Err(ContainerError::Endless)
}

/// Of a record that is none of channels and messages, nothing.
fn take(op: u8, body: &[u8], topics: &mut BTreeMap<u16, String>, give: &mut dyn FnMut(ContainedMessage)) {
    let mut fields = Fields(body);
    match op {
        op::CHANNEL => {
            if let (Some(number), Some(_), Some(topic)) = (fields.u16(), fields.u16(), fields.text()) {
                topics.insert(number, topic);
            }
        }
        op::MESSAGE => {
            let parts = (fields.u16(), fields.u32(), fields.u64(), fields.u64());
            if let (Some(channel), Some(sequence), Some(time), Some(_)) = parts
                && let Some(topic) = topics.get(&channel).cloned()
            {
                give(ContainedMessage { topic, sequence, time, data: fields.0.to_vec() });
            }
        }
        _ => {}
    }
}

/// The records of a chunk; `None`: it is shorter than it says.
fn unpacked(body: &[u8]) -> Option<Result<Vec<u8>, ContainerError>> {
    let mut fields = Fields(body);
    let (_, _, size) = (fields.u64()?, fields.u64()?, fields.u64()?);
    let (sum, packing, length) = (fields.u32()?, fields.text()?, fields.u64()?);
    let packed = fields.take(usize::try_from(length).ok()?)?;
    let records = match packing.as_str() {
        "" => packed.to_vec(),
        "zstd" if size > MOST_UNPACKED => {
            return Some(Err(ContainerError::Unpack(format!("it would have {size} bytes"))));
        }
        "zstd" => match zstd::bulk::decompress(packed, usize::try_from(size).ok()?) {
            Ok(records) => records,
            Err(error) => return Some(Err(ContainerError::Unpack(error.to_string()))),
        },
        _ => return Some(Err(ContainerError::Packing(packing))),
    };
    // 0: nobody has worked it out.
    let is_whole = sum == 0 || crc32fast::hash(&records) == sum;
    Some(if is_whole { Ok(records) } else { Err(ContainerError::Checksum) })
}

/// What is left of a record, or of records.
struct Fields<'a>(&'a [u8]);

impl<'a> Fields<'a> {
    fn take(&mut self, length: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(length)?;
        self.0 = rest;
        Some(taken)
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.take(N)?.try_into().ok()
    }

    fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    fn text(&mut self) -> Option<String> {
        let length = usize::try_from(self.u32()?).ok()?;
        self.take(length).map(|bytes| String::from_utf8_lossy(bytes).into_owned())
    }

    fn record(&mut self) -> Option<(u8, &'a [u8])> {
        let [op] = self.array()?;
        let length = usize::try_from(self.u64()?).ok()?;
        Some((op, self.take(length)?))
    }
}

#[cfg(test)]
mod tests {
    use super::{ContainedMessage, ContainerError, ContainerWriter, read};

    fn written(messages: u32) -> Vec<u8> {
        let mut writer = ContainerWriter::new("test");
        let channels = [writer.channel("/a", "A", "{}"), writer.channel("/b", "B", "{}")];
        for at in 0..messages {
            let data = format!("{{\"n\":{}}}", u64::from(at) * 7919 % 10_007);
            let channel = channels[(at % 2) as usize];
            writer.message(channel, at, u64::from(at) * 1_000, data.as_bytes()).unwrap();
        }
        writer.finish().unwrap()
    }

    fn taken(file: &[u8]) -> (Vec<ContainedMessage>, Result<(), ContainerError>) {
        let mut all = Vec::new();
        let end = read(file, &mut |message| all.push(message));
        (all, end)
    }

    #[test]
    fn what_is_written_is_read_in_order() {
        let file = written(20_000);
        let (all, end) = taken(&file);
        assert_eq!((all.len(), end), (20_000, Ok(())));
        assert!(all.iter().zip(0..).all(|(m, at)| m.sequence == at && m.time == u64::from(at) * 1_000));
        assert_eq!((all[3].topic.as_str(), all[3].data.as_slice()), ("/b", &b"{\"n\":3743}"[..]));
        assert_eq!(file, written(20_000), "the same bytes");
    }

    #[test]
    fn of_a_cut_file_whole_chunks_are_read() {
        let file = written(20_000);
        let (all, end) = taken(&file[..file.len() * 3 / 4]);
        assert!(!all.is_empty() && all.len() < 20_000, "{}", all.len());
        assert!(matches!(end, Err(ContainerError::Cut(_))), "{end:?}");
        for length in 0..200 {
            assert!(taken(&file[..length]).1.is_err());
        }
    }

    #[test]
    fn damage_is_found() {
        assert_eq!(taken(b"{\"hrdsl\":\"trace\"}").1, Err(ContainerError::NotMcap));
        let mut file = written(100);
        let middle = file.len() / 3;
        file[middle] ^= 0xff;
        assert!(taken(&file).1.is_err());
    }
}
