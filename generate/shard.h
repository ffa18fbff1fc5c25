#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "files/file_lock.h"
#include "files/journal.h"
#include "files/plan_file.h"
#include "generate/sample_tally.h"

namespace toile::generate {

/// One of the equal parts that a corpus is divided into; one alone is the whole.
struct ShardNumber {
    int index = 0, count = 1;  ///< 0 <= index < count
};

/// Slots of a corpus, one after the other.
struct SlotRange {
    int first = 0, end = 0;
    int size() const { return end - first; }
};

SlotRange shard_slots(ShardNumber shard, int samples);
/// "shard_00003_of_00016"
std::string shard_folder_name(ShardNumber shard);
/// The shards whose folders are there, in order; folders of other names are passed over.
std::vector<ShardNumber> shards_in(const std::string& folder);

/// A worker's part of a corpus on the disk. Samples come in any order; each is in a journal, on the disk, when `add`
/// returns. When all samples of a part (`part_samples` slots) are there it is sealed: written to part_00007.h5, a data
/// set file of its own (see files::DatasetWriter), under another name first, synced, renamed; then its journal goes.
/// So a process may be killed at any moment and loses no sample that was added. Memory does not depend on the number of
/// samples, but for one byte each.
///
/// Construction locks the folder, and finds out what is there: every digest is computed again. What is damaged, and
/// what failed as `crashed` or `out_of_memory`, is missing again.
class Shard {
  public:
    struct Options {
        int part_samples = 256;
        int deflate = 4;
    };

    /// Throws Error where another process works on the shard, its files belong to another configuration or program, or
    /// the folder cannot be used.
    Shard(const std::string& corpus_folder, ShardNumber number, const files::CorpusPlan& plan, const Options& options);

    std::vector<int> missing() const;  ///< slots of the corpus, in order
    bool is_complete() const { return missing().empty(); }
    /// `bytes`: files::sample_bytes of the slot's sample. Throws Error where they did not reach the disk.
    void add(int slot, std::string_view bytes);

    /// Takes over the sound samples of a data set of the whole corpus. Throws Error where it is another corpus'.
    void adopt(const std::string& dataset);

    ShardNumber number() const { return number_; }
    SlotRange slots() const { return slots_; }
    const std::string& folder() const { return folder_; }
    const SampleTally& tally() const { return tally_; }                   ///< of all samples that are there
    const std::vector<std::string>& remarks() const { return remarks_; }  ///< damage that was found, one sentence each
    int lock_descriptor() const { return lock_.descriptor(); }            ///< to be closed in child processes

  private:
    struct OpenPart {
        files::Journal journal;
        std::map<int, int> record;  ///< slot -> record of the journal
        /// The part as far as it has come, so that sealing is no long halt; null where samples are too far out of order
        /// or came from an earlier process: then it is written from the journal in one go.
        std::unique_ptr<files::DatasetWriter> writer = nullptr;
        int in_order = 0;  ///< samples from the part's first on without a gap
    };

    int part_of(int slot) const { return (slot - slots_.first) / options_.part_samples; }
    SlotRange part_slots(int part) const;
    std::string part_path(int part) const;
    std::string journal_path(int part) const;
    OpenPart& open_part(int part);
    void recover(int part);
    bool recover_sealed(int part);
    void check_owner(const files::DatasetReader& reader) const;
    std::optional<files::SampleRecord> sound_sample(const files::DatasetReader& reader, int row, int slot);
    void forget_failure(std::int64_t pose) const;
    void unseal(int part, const files::DatasetReader& reader, const std::vector<int>& sound);
    void recover_journal(int part);
    void note_damage(const std::string& what) { remarks_.push_back(what); }
    std::unique_ptr<files::DatasetWriter> part_writer(int part) const;
    void write_along(OpenPart& opened, int part, int slot, files::SampleRecord sample);
    void seal(int part);

    const ShardNumber number_;
    const files::CorpusPlan& plan_;
    const Options options_;
    const SlotRange slots_;
    const std::string corpus_folder_, folder_;
    files::FileLock lock_;
    std::vector<char> there_;       ///< by slot - slots_.first
    std::map<int, OpenPart> open_;  ///< parts with samples that are not sealed
    SampleTally tally_;
    std::vector<std::string> remarks_;
};

}  // namespace toile::generate
