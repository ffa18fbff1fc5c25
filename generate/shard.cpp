#include "generate/shard.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "cloth/error.h"
#include "files/sample_bytes.h"
#include "simulate/certificate.h"

namespace toile::generate {

namespace fs = std::filesystem;

namespace {

/// Failures that come from the machine rather than from the pose.
bool failed_by_machine(const files::SampleRecord& sample) {
    return simulate::process_failed(static_cast<simulate::DrapeStatus>(sample.status));
}

std::string prepared_folder(const std::string& corpus_folder, ShardNumber number) {
    const fs::path folder = fs::path(corpus_folder) / shard_folder_name(number);
    std::error_code failure;
    fs::create_directory(folder, failure);
    if (failure) throw Error("the shard's folder cannot be made: " + failure.message(), folder.string());
    return folder.string();
}

files::FileLock taken(const std::string& folder) {
    std::optional<files::FileLock> lock = files::FileLock::try_take((fs::path(folder) / "lock").string());
    if (!lock)
        throw Error("another process is at work on this shard", folder,
                    "let it finish, or end it first: toile status shows it");
    return std::move(*lock);
}

constexpr std::string_view owner_mark = "configuration ";

/// Of which corpus a journal is: its first record.
std::string journal_owner(const files::DatasetHeader& header) {
    return std::string(owner_mark) + header.config_hash + ", toile " + header.program_version;
}

}  // namespace

SlotRange shard_slots(ShardNumber shard, int samples) {
    const auto bound = [&](std::int64_t k) { return static_cast<int>(k * samples / shard.count); };
    return {bound(shard.index), bound(shard.index + 1)};
}

std::string shard_folder_name(ShardNumber shard) {
    char name[48];
    std::snprintf(name, sizeof name, "shard_%05d_of_%05d", shard.index, shard.count);
    return name;
}

std::vector<ShardNumber> shards_in(const std::string& folder) {
    std::vector<ShardNumber> shard;
    std::error_code failure;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, failure)) {
        ShardNumber number;
        const std::string name = entry.path().filename().string();
        if (std::sscanf(name.c_str(), "shard_%d_of_%d", &number.index, &number.count) == 2 && number.count >= 1 &&
            number.index >= 0 && number.index < number.count && name == shard_folder_name(number))
            shard.push_back(number);
    }
    std::sort(shard.begin(), shard.end(), [](ShardNumber a, ShardNumber b) {
        return std::make_pair(a.count, a.index) < std::make_pair(b.count, b.index);
    });
    return shard;
}

Shard::Shard(const std::string& corpus_folder, ShardNumber number, const files::CorpusPlan& plan,
             const Options& options)
    : number_(number),
      plan_(plan),
      options_(options),
      slots_(shard_slots(number, plan.sample_count())),
      corpus_folder_(corpus_folder),
      folder_(prepared_folder(corpus_folder, number)),
      lock_(taken(folder_)),
      there_(static_cast<size_t>(slots_.size()), 0) {
    for (int part = 0; part * options_.part_samples < slots_.size(); ++part) recover(part);
}

SlotRange Shard::part_slots(int part) const {
    const int first = slots_.first + part * options_.part_samples;
    return {first, std::min(first + options_.part_samples, slots_.end)};
}

std::string Shard::part_path(int part) const {
    char name[32];
    std::snprintf(name, sizeof name, "part_%05d.h5", part);
    return (fs::path(folder_) / name).string();
}

std::string Shard::journal_path(int part) const {
    char name[32];
    std::snprintf(name, sizeof name, "journal_%05d", part);
    return (fs::path(folder_) / name).string();
}

std::vector<int> Shard::missing() const {
    std::vector<int> slot;
    for (int i = 0; i < slots_.size(); ++i)
        if (!there_[i]) slot.push_back(slots_.first + i);
    return slot;
}

Shard::OpenPart& Shard::open_part(int part) {
    const auto found = open_.find(part);
    if (found != open_.end()) return found->second;
    const std::string owner = journal_owner(plan_.header), path = journal_path(part);
    files::Journal journal(path);
    if (journal.count() > 0 && journal.read(0).rfind(owner_mark, 0) != 0) {
        note_damage(path + " does not say any more whose it is, its samples are made again");
        fs::remove(path);
        journal = files::Journal(path);
    }
    if (journal.count() == 0) journal.append(owner);
    if (journal.read(0) != owner)
        throw Error("the journal belongs to another corpus: " + journal.read(0), path,
                    "choose another --out, or remove the shard's folder");
    return open_.emplace(part, OpenPart{std::move(journal), {}}).first->second;
}

void Shard::recover(int part) {
    if (fs::exists(part_path(part)) && recover_sealed(part)) {
        fs::remove(journal_path(part));  // killed between sealing and this
        return;
    }
    if (fs::exists(journal_path(part))) recover_journal(part);
}

/// True where the part is as it should be. Else what is sound of it goes back into the journal, and the part is
/// removed.
bool Shard::recover_sealed(int part) {
    const std::string path = part_path(part);
    const SlotRange range = part_slots(part);
    std::unique_ptr<files::DatasetReader> reader;
    try {
        reader = std::make_unique<files::DatasetReader>(path);
    } catch (const Error& error) {
        note_damage(path + " cannot be read, its samples are made again: " + error.what());
        fs::remove(path);
        return false;
    }
    check_owner(*reader);
    std::vector<int> sound;  // rows
    SampleTally tally = tally_;
    for (int row = 0; row < std::min(reader->sample_count(), range.size()); ++row) {
        const std::optional<files::SampleRecord> sample = sound_sample(*reader, row, range.first + row);
        if (!sample) continue;
        sound.push_back(row);
        tally.add(*sample, corpus_folder_);
    }
    if (static_cast<int>(sound.size()) == range.size()) {
        tally_ = tally;
        std::fill_n(there_.begin() + (range.first - slots_.first), range.size(), 1);
        return true;
    }
    unseal(part, *reader, sound);
    return false;
}

std::optional<files::SampleRecord> Shard::sound_sample(const files::DatasetReader& reader, int row, int slot) {
    const std::string name = "pose " + std::to_string(plan_.pose_number[slot]);
    try {
        files::SampleRecord sample = reader.read(row);
        if (sample.id != plan_.pose_number[slot] || files::sample_digest(sample) != reader.stored_digest(row))
            note_damage(name + " in " + reader.file().path() + " is damaged, and is made again");
        else if (failed_by_machine(sample))
            forget_failure(sample.id);
        else
            return sample;
    } catch (const Error& error) {
        note_damage(name + " in " + reader.file().path() + " cannot be read, and is made again: " + error.what());
    }
    return std::nullopt;
}

/// What was kept of a failure goes where it is tried again.
void Shard::forget_failure(std::int64_t pose) const {
    std::error_code ignored;
    fs::remove(replay_path(corpus_folder_, pose), ignored);
}

void Shard::unseal(int part, const files::DatasetReader& reader, const std::vector<int>& sound) {
    fs::remove(journal_path(part));
    files::Journal journal(journal_path(part));
    journal.append(journal_owner(plan_.header));
    for (const int row : sound) journal.append(files::sample_bytes(reader.read(row)));
    fs::remove(part_path(part));
}

void Shard::recover_journal(int part) {
    OpenPart& opened = open_part(part);
    if (opened.journal.damaged() > 0)
        note_damage(std::to_string(opened.journal.damaged()) + " samples in " + opened.journal.path() +
                    " are damaged, and are made again");
    const SlotRange range = part_slots(part);
    std::map<std::int64_t, int> slot_of;
    for (int slot = range.first; slot < range.end; ++slot) slot_of[plan_.pose_number[slot]] = slot;
    std::vector<int> again;
    for (int k = 1; k < opened.journal.count(); ++k) {
        const files::SampleRecord sample = files::sample_from_bytes(opened.journal.read(k));
        const auto slot = slot_of.find(sample.id);
        if (slot == slot_of.end())
            throw Error("the journal has a sample of pose " + std::to_string(sample.id) + ", which is not in its part",
                        opened.journal.path(), "remove the shard's folder");
        if (opened.record.count(slot->second)) continue;
        if (failed_by_machine(sample)) {
            again.push_back(slot->second);
            continue;
        }
        opened.record[slot->second] = k;
        there_[slot->second - slots_.first] = 1;
        tally_.add(sample, corpus_folder_);
    }
    for (const int slot : again)
        if (!opened.record.count(slot)) forget_failure(plan_.pose_number[slot]);
    if (static_cast<int>(opened.record.size()) == range.size()) seal(part);
}

void Shard::add(int slot, std::string_view bytes) {
    const int part = part_of(slot);
    OpenPart& opened = open_part(part);
    const bool fresh = opened.record.empty();
    opened.journal.append(bytes);
    opened.record[slot] = opened.journal.count() - 1;
    there_[slot - slots_.first] = 1;
    files::SampleRecord sample = files::sample_from_bytes(bytes);
    tally_.add(sample, corpus_folder_);
    if (fresh) opened.writer = part_writer(part);
    if (opened.writer) write_along(opened, part, slot, std::move(sample));
    if (static_cast<int>(opened.record.size()) == part_slots(part).size()) seal(part);
}

/// The writer keeps samples that came early in memory: as long as they are few.
void Shard::write_along(OpenPart& opened, int part, int slot, files::SampleRecord sample) {
    constexpr int most_early = 16;
    const int first = part_slots(part).first;
    while (opened.record.count(first + opened.in_order)) ++opened.in_order;
    if (static_cast<int>(opened.record.size()) - opened.in_order > most_early)
        opened.writer.reset();
    else
        opened.writer->write(slot - first, std::move(sample));
}

void Shard::adopt(const std::string& dataset) {
    std::unique_ptr<files::DatasetReader> reader;
    try {
        reader = std::make_unique<files::DatasetReader>(dataset);
    } catch (const Error& error) {
        return note_damage(dataset + " cannot be read, all is made again: " + error.what());
    }
    check_owner(*reader);
    std::map<std::int64_t, int> slot_of;
    for (int slot = slots_.first; slot < slots_.end; ++slot) slot_of[plan_.pose_number[slot]] = slot;
    const std::vector<std::int64_t> id = reader->file().read<std::int64_t>("/samples/id").value;
    for (int row = 0; row < reader->sample_count(); ++row) {
        const auto slot = slot_of.find(id[row]);
        if (slot == slot_of.end() || there_[slot->second - slots_.first]) continue;
        if (const auto sample = sound_sample(*reader, row, slot->second))
            add(slot->second, files::sample_bytes(*sample));
    }
}

void Shard::check_owner(const files::DatasetReader& reader) const {
    const std::string owner = journal_owner(reader.header());
    if (owner != journal_owner(plan_.header))
        throw Error("the file belongs to another corpus: " + owner, reader.file().path(),
                    "choose another --out, or remove the file");
}

std::unique_ptr<files::DatasetWriter> Shard::part_writer(int part) const {
    const SlotRange range = part_slots(part);
    files::CorpusPart place;
    place.shard = number_.index;
    place.shards = number_.count;
    place.first_slot = range.first;
    place.corpus_samples = plan_.sample_count();
    return std::make_unique<files::DatasetWriter>(part_path(part), plan_.header, range.size(), options_.deflate, place);
}

void Shard::seal(int part) {
    OpenPart& opened = open_.at(part);
    if (!opened.writer) {
        opened.writer = part_writer(part);
        for (const auto& [slot, record] : opened.record)
            opened.writer->write(slot - part_slots(part).first, files::sample_from_bytes(opened.journal.read(record)));
    }
    opened.writer->finish();
    open_.erase(part);
    fs::remove(journal_path(part));
}

}  // namespace toile::generate
