#include "app/summary.h"

#include <spdlog/fmt/fmt.h>

#include <cstdio>
#include <map>

namespace toile::app {
namespace {

template <class... Args>
void say(fmt::format_string<Args...> format, Args&&... args) {
    const std::string text = fmt::format(format, std::forward<Args>(args)...);
    std::puts(text.c_str());
}

void print_failures(const generate::GenerateSummary& summary) {
    std::map<std::string, std::string> poses;
    for (const generate::FailedSample& one : summary.failed) {
        std::string& list = poses[one.reason];
        list += (list.empty() ? "" : ", ") + std::to_string(one.pose);
    }
    for (const auto& [reason, list] : poses) say("  not accepted     {}: poses {}", reason, list);
    for (const generate::FailedSample& one : summary.failed)
        say("  run again        toile simulate --replay {} --out pose.obj", one.replay);
}

void print_tries(const std::vector<simulate::TryRecord>& tries) {
    if (tries.size() < 2) return;
    for (const simulate::TryRecord& one : tries)
        say("  try              {}: {}, residual force {:.3e}, {} crossings, {} iterations",
            simulate::rung_name(one.rung), simulate::status_reason(one.status), one.certificate.residual_force,
            one.certificate.self_intersections, one.certificate.iterations);
}

}  // namespace

void print_summary(const generate::GenerateSummary& s) {
    say("{}", s.dataset);
    say("  samples          {} of {} accepted, {} vertices, {} triangles each", s.accepted, s.samples, s.vertices,
        s.triangles);
    if (s.climbed > 0) say("  tried again      {} of the accepted", s.climbed);
    print_failures(s);
    if (s.accepted > 0)
        say("  worst accepted   penetration {:.2f} mm, stretch {:.3f}, residual force {:.1e} of the weight",
            1e3 * s.worst_penetration, s.worst_stretch, s.worst_residual);
    if (s.image_width > 0 && s.accepted > 0)
        say("  images           {} x {} pixels, {} channels; read back within {:.3f} mm (root mean square {:.3f} mm)",
            s.image_width, s.image_height, s.image_channels, 1e3 * s.image_error_max, 1e3 * s.image_error_rms);
    if (s.samples > 0)
        say("  disk             {:.1f} MB, {:.1f} kB a sample", 1e-6 * static_cast<double>(s.bytes),
            1e-3 * static_cast<double>(s.bytes) / s.samples);
    say("  time             {:.1f} s in all, {:.2f} s a drape", s.seconds, s.mean_drape_seconds);
    for (const std::string& remark : s.remarks) say("  note             {}", remark);
}

void print_look(const std::vector<std::string>& path) {
    for (const std::string& one : path) say("  look at          {}", one);
}

void print_export(const generate::ExportSummary& s) {
    for (const std::string& path : s.path) say("{}", path);
    say("  samples          {}, {:.1f} MB", s.samples, 1e-6 * static_cast<double>(s.bytes));
    if (s.not_finite > 0) say("  left out         {} failed samples that are not finite", s.not_finite);
}

void print_validation(const generate::Validation& validation) {
    if (validation.defect.empty())
        say("  valid            {} samples checked, {} accepted", validation.samples, validation.accepted);
    if (validation.recomputed > 0) say("  made again       {} samples", validation.recomputed);
    for (const std::string& remark : validation.remark) say("  note             {}", remark);
    for (const std::string& defect : validation.defect) say("  not valid        {}", defect);
}

void print_projection(const generate::ProjectSummary& s, const std::string& path) {
    say("{}", path);
    say("  samples          {} of {} converged, {} vertices, {} edges each", s.converged, s.samples, s.vertices,
        s.edges);
    const double n = s.samples > 0 ? static_cast<double>(s.samples) : 1.0;
    if (s.samples > 0) {
        say("  worst residual   {:.2e} after at most {} iterations", s.worst_residual, s.most_iterations);
        say("  forward          {:.3f} ms a sample: sweeps {:.3f}, assembly {:.3f}, factor {:.3f}, solve {:.3f}",
            1e3 * s.forward / n, 1e3 * s.sweep / n, 1e3 * s.assembly / n, 1e3 * s.factor / n, 1e3 * s.solve / n);
    }
    if (s.gradient && s.samples > 0) {
        say("  gradient         {:.3f} ms a sample", 1e3 * s.backward / n);
        if (s.near_kink > 0)
            say("  near a kink      {} samples: taut edges almost without force, the gradient may be one-sided",
                s.near_kink);
    }
    say("  time             {:.2f} s in all", s.seconds);
}

void print_drape(const simulate::DrapeResult& result, const std::string& path) {
    const simulate::Certificate& c = result.certificate;
    say("{}", path);
    say("  status           {}", simulate::status_reason(result.status));
    say("  residual force   {:.3e} of the garment's weight", c.residual_force);
    say("  penetration      {:.3f} mm", 1e3 * c.body_penetration);
    say("  crossings        {} triangle pairs of the cloth, {} with the body", c.self_intersections, c.body_crossings);
    say("  stretch          {:.4f} to {:.4f}", c.min_stretch, c.max_stretch);
    say("  largest speed    {:.2e} m/s; {:.1f} % of the vertices move", c.max_speed, 100 * c.moving_share);
    print_tries(result.tries);
    const simulate::DrapeReport& r = result.report;
    say("  time             {:.2f} s: level set {:.2f}, contact {:.2f}, self-contact {:.2f}, assembly {:.2f}, factor "
        "{:.2f}, "
        "line search {:.2f}, certificate {:.2f}",
        c.seconds, r.level_set_seconds, r.contact_seconds, r.self_contact_seconds, r.assembly_seconds, r.factor_seconds,
        r.line_search_seconds, r.certificate_seconds);
    say("  iterations       {} solver, {} path steps, {} level sets", r.iterations, r.path_steps, r.level_sets);
    if (r.untangled > 0) say("  untangled        {} crossings of the start", r.untangled);
    if (c.tries > 1) say("  in all tries     {} solver, {} path steps", c.iterations, c.path_steps);
}

void print_replay(const generate::Replayed& replayed, const std::string& path) {
    print_drape(replayed.drape, path);
    const files::ReplayRecord& recorded = replayed.recorded;
    const std::string what = recorded.suite_case.empty() ? "pose " + std::to_string(recorded.id) : recorded.suite_case;
    say("  recorded         {}: {}, residual force {:.3e} of the garment's weight", what, recorded.reason,
        recorded.certificate.residual_force);
    say("  the same         {}, {}", replayed.same_certificate ? "certificate" : "another certificate",
        replayed.same_cloth ? "cloth to the last bit" : "another cloth");
    if (!replayed.same_inputs)
        say("  note             the configuration, or a file it names, is not what it was when this failed");
}

}  // namespace toile::app
