#pragma once

#include <string>
#include <vector>

#include "generate/export.h"
#include "generate/generate.h"
#include "generate/project.h"
#include "generate/replay.h"
#include "generate/validate.h"
#include "simulate/drape.h"

/// What is said on stdout when work is done.
namespace toile::app {

void print_summary(const generate::GenerateSummary& summary);
void print_look(const std::vector<std::string>& path);
void print_export(const generate::ExportSummary& summary);
void print_validation(const generate::Validation& validation);
void print_projection(const generate::ProjectSummary& summary, const std::string& path);
void print_drape(const simulate::DrapeResult& result, const std::string& path);
void print_replay(const generate::Replayed& replayed, const std::string& path);

}  // namespace toile::app
