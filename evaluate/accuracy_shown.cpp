#include "evaluate/accuracy_shown.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

namespace toile::evaluate {
namespace {

constexpr double usual_mu = 0.1;

/// Numbers of samples to take of train, validation and test, out of those there are.
std::array<int, 3> shares(const std::array<int, 3>& there, int most) {
    std::array<int, 3> take{};
    std::array<int, 3> wanted{most / 4, most / 4, most - 2 * (most / 4)};
    int left = most;
    for (size_t k = 0; k < 3; ++k) {
        take[k] = std::min(wanted[k], there[k]);
        left -= take[k];
    }
    for (const size_t k : {2u, 1u, 0u}) {
        const int more = std::min(left, there[k] - take[k]);
        take[k] += more;
        left -= more;
    }
    return take;
}

/// The method that stands for the quasistatic prior; null where there is none.
const PriorMethod* usual_quasistatic(const std::vector<PriorMethod>& methods) {
    const PriorMethod* chosen = nullptr;
    const auto off = [](const PriorMethod& one) { return std::abs(std::log(one.setting / usual_mu)); };
    for (const PriorMethod& one : methods) {
        if (one.kind != PriorMethod::Kind::quasistatic || one.name == "quasistatic@mu=vertex") continue;
        if (one.name == "quasistatic@mu=best") return &one;
        if (!chosen || off(one) < off(*chosen)) chosen = &one;
    }
    return chosen;
}

const PriorMethod* first_of(const std::vector<PriorMethod>& methods, const std::string& beginning) {
    for (const PriorMethod& one : methods)
        if (one.name.starts_with(beginning)) return &one;
    return nullptr;
}

}  // namespace

std::vector<int> worst_samples(const std::vector<int>& split, const std::vector<double>& error, int most) {
    std::array<std::vector<int>, 3> row;
    for (size_t k = 0; k < split.size(); ++k) row[static_cast<size_t>(split[k])].push_back(static_cast<int>(k));
    std::array<int, 3> there{};
    for (size_t s = 0; s < 3; ++s) there[s] = static_cast<int>(row[s].size());
    const std::array<int, 3> take = shares(there, most);
    std::vector<int> chosen;
    for (const size_t s : {2u, 1u, 0u}) {
        std::stable_sort(row[s].begin(), row[s].end(),
                         [&](int a, int b) { return error[static_cast<size_t>(a)] > error[static_cast<size_t>(b)]; });
        chosen.insert(chosen.end(), row[s].begin(), row[s].begin() + take[s]);
    }
    return chosen;
}

std::vector<ShownView> shown_views(const std::vector<PriorMethod>& methods) {
    std::vector<ShownView> views{{"target", "the truth", {}}, {"predicted", methods.front().title, methods.front()}};
    if (const PriorMethod* one = first_of(methods, "inextensibility@"))
        views.push_back({"inextensibility", one->title, *one});
    if (const PriorMethod* one = usual_quasistatic(methods)) views.push_back({"quasistatic", one->title, *one});
    if (const PriorMethod* one = first_of(methods, "quasistatic@mu=vertex"))
        views.push_back({"quasistatic_mu_vertex", one->title, *one});
    return views;
}

Shown make_shown(const TrueSamples& samples, const ClothJudge& judge, const std::vector<int>& slot,
                 const PredictionSource& source, const std::vector<PriorMethod>& methods, PriorRunner& runner,
                 int jobs) {
    Shown shown;
    if (slot.empty()) return shown;
    shown.view = shown_views(methods);
    const std::vector<TrueSample> truth = samples.read(slot, jobs);
    std::vector<double> predicted;
    for (const TrueSample& one : truth) {
        shown.sample.push_back({one.record.id, one.record.split, one.body, one.record.image, {}});
        const Positions position = source.predict(one.record);
        predicted.insert(predicted.end(), position.data(), position.data() + position.size());
    }
    for (const ShownView& view : shown.view) {
        const std::vector<double> position = runner.run(view.method, predicted).position;
        for (size_t k = 0; k < truth.size(); ++k) {
            const Positions& target = truth[k].target.position;
            Positions cloth = target;
            if (view.key != "target")
                std::copy_n(position.begin() + static_cast<std::ptrdiff_t>(k) * target.size(), target.size(),
                            cloth.data());
            shown.sample[k].cloth.push_back({cloth, judge.fields(cloth, target)});
        }
    }
    return shown;
}

}  // namespace toile::evaluate
