#pragma once

#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace toile::files {

/// How the samples' own figures are spread about a metric, in its unit.
struct MetricDistribution {
    double median = 0, p95 = 0, p99 = 0, largest = 0;
};

enum class MetricDirection { lower, higher, none };  ///< which way is better; none: told, not judged

/// One figure of an evaluation or a bench: what reports show, baselines hold and gates compare.
struct Metric {
    static constexpr double missing = std::numeric_limits<double>::quiet_NaN();

    std::string name;        ///< unique in its file: "accuracy/ridge/test/quasistatic@mu=0.1/sqrt_mse"
    double value = missing;  ///< not finite where it could not be measured
    std::string unit;        ///< "mm", "J", "ratio", "%"
    MetricDirection direction = MetricDirection::none;
    double tolerance = 0.05;  ///< relative: how much worse than a baseline is no regression
    double low = missing;     ///< 95 % interval; neither end where there is none, and it is written as the value itself
    double high = missing;
    int samples = 0;  ///< that the value is made of; 0 where it has none
    std::optional<MetricDistribution> distribution;
    std::optional<double> floor;  ///< the simulator's noise in this quantity, in the metric's unit
};

/// What an evaluation leaves: `<kind>.json`.
struct MetricFile {
    struct Line {
        std::string name, value;
    };
    std::string kind;             ///< "accuracy", "runtime", "stability", "noise", "strain", or a bench's name
    std::string program_version;  ///< filled in by reading; writing puts this program's own
    std::vector<Line> about;      ///< "dataset", "command", "date" ...: names are unique
    std::vector<Metric> metric;
};

/// The document: {"format": "toile metrics", "version": 1, "kind", "program_version", "about", "metric"}. A number that
/// is not finite is null. A kind's owner appends members of its own. Throws Error for a name that is there twice.
nlohmann::ordered_json metric_document(const MetricFile& file);

/// Writes the document followed by the members of `own` (an object), whole or not at all. Throws Error.
void write_metric_file(const std::string& path, const MetricFile& file);
void write_metric_file(const std::string& path, const MetricFile& file, const nlohmann::ordered_json& own);

/// The text of such a file.
std::string metric_text(const MetricFile& file);

/// Reads what the former wrote; members of the kind's own are passed over. Throws Error, naming file and key, for a
/// file that is missing, damaged, of another kind (an empty `kind` takes any) or of another version.
MetricFile read_metric_file(const std::string& path, const std::string& kind = {});

/// The same, checked as strictly, as the whole document with the kind's own members.
nlohmann::ordered_json read_metric_document(const std::string& path, const std::string& kind = {});

/// The same of a document at hand; `path` is for the messages.
MetricFile as_metric_file(const nlohmann::ordered_json& document, const std::string& path,
                          const std::string& kind = {});

/// "lower", "higher", "none".
const char* direction_name(MetricDirection direction);

}  // namespace toile::files
