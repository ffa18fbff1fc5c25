#include "app/progress.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <cstdio>

namespace toile::app {
namespace {

using Clock = std::chrono::steady_clock;

std::string time_text(double seconds) {
    const int whole = static_cast<int>(seconds + 0.5);
    if (whole >= 3600) return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
    return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

std::string failed_text(int failed) {
    return failed > 0 ? fmt::format(", {} not accepted", failed) : std::string();
}

}  // namespace

void log_to_stderr() {
    spdlog::set_default_logger(std::make_shared<spdlog::logger>("", std::make_shared<spdlog::sinks::stderr_sink_mt>()));
}

ProgressDisplay::ProgressDisplay() : terminal_(isatty(STDERR_FILENO) == 1) {}

ProgressDisplay::~ProgressDisplay() {
    finish();
}

void ProgressDisplay::finish() {
    if (line_open_) std::fputc('\n', stderr);
    line_open_ = false;
}

void ProgressDisplay::operator()(const generate::Progress& progress) {
    const auto now = Clock::now();
    const bool new_stage = progress.stage != stage_;
    if (new_stage) {
        finish();
        stage_ = progress.stage;
        stage_start_ = now;
    }
    const double elapsed = std::chrono::duration<double>(now - stage_start_).count();
    std::string text = stage_;
    if (progress.total > 0) {
        text += fmt::format(" {}/{}{}", progress.done, progress.total, failed_text(progress.failed));
        if (progress.done > 0 && progress.done < progress.total)
            text += fmt::format(", {} left", time_text(elapsed * (progress.total - progress.done) / progress.done));
        if (progress.done == progress.total) text += fmt::format(", {} taken", time_text(elapsed));
    }
    const bool finished = progress.total > 0 && progress.done == progress.total;
    const bool due = new_stage || finished || std::chrono::duration<double>(now - last_shown_).count() > 5.0;
    if (terminal_)
        rewrite(text);
    else if (due)
        spdlog::info(text);
    if (terminal_ || due) last_shown_ = now;
}

void ProgressDisplay::rewrite(const std::string& text) {
    std::fprintf(stderr, "\r\x1b[K%s", text.c_str());
    std::fflush(stderr);
    line_open_ = true;
}

}  // namespace toile::app
