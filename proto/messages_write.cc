#include <algorithm>

#include "proto/edr.h"
#include "proto/messages.h"
#include "proto/messages_internal.h"
#include "proto/processes/simplify.h"

namespace proto {
namespace {

void write_pair(JsonWriter& json, double a, double b) {
  json.begin_array().number(a).number(b).end_array();
}

void write_box(JsonWriter& json, const std::array<double, 4>& box) {
  json.begin_array();
  for (const double bound : box) json.number(bound);
  json.end_array();
}

void write_strings(JsonWriter& json, std::span<const std::string> texts) {
  json.begin_array();
  for (const std::string& text : texts) json.string(text);
  json.end_array();
}

void write_if_any(JsonWriter& json, std::string_view name, std::string_view text) {
  if (!text.empty()) json.key(name).string(text);
}

void write_source(JsonWriter& json, const SourceInfo& source) {
  json.begin_object();
  json.key("width").integer(static_cast<std::uint64_t>(source.width));
  json.key("height").integer(static_cast<std::uint64_t>(source.height));
  json.key("dataType").string(source.data_type);
  json.key("nodata");
  if (source.nodata) {
    json.number(*source.nodata);
  } else {
    json.null();
  }
  json.end_object();
}

void write_tin(JsonWriter& json, const TinDocument& tin, const FileReport* file = nullptr) {
  json.begin_object();
  json.key("id").string(tin.id);
  json.key("title").string(tin.title);
  json.key("crs");
  tin.crs.empty() ? json.null() : json.string(tin.crs);
  json.key("resolution");
  write_pair(json, tin.resolution[0], tin.resolution[1]);
  json.key("origin");
  write_pair(json, tin.origin.x, tin.origin.y);
  json.key("revision").integer(tin.revision);
  json.key("vertexCount").integer(tin.vertex_count);
  json.key("triangleCount").integer(tin.triangle_count);
  json.key("bbox");
  tin.bbox ? write_box(json, *tin.bbox) : void(json.null());
  json.key("zRange");
  tin.z_range ? write_pair(json, (*tin.z_range)[0], (*tin.z_range)[1]) : void(json.null());
  json.key("digest").string(tin.digest);
  json.key("verticalUnit");
  tin.vertical_unit.empty() ? json.null() : json.string(tin.vertical_unit);
  if (tin.source) {
    json.key("source");
    write_source(json, *tin.source);
  }
  if (file != nullptr) json.key("duplicates").integer(file->duplicates);
  if (file != nullptr && file->simplification != nullptr) {
    json.key("simplification");
    write_simplify_results(json, *file->simplification);
  }
  write_links(json, tin.links);
  json.end_object();
}

void write_data_query(JsonWriter& json, const DataQuery& query, std::string_view vertical_unit) {
  json.key(query.type).begin_object().key("link").begin_object();
  json.key("href").string(query.href);
  json.key("rel").string("data");
  json.key("title").string(query.title);
  json.key("variables").begin_object();
  json.key("title").string(query.title);
  json.key("query_type").string(query.type);
  if (query.type == "cube") {
    json.key("height_units").begin_array();
    if (!vertical_unit.empty()) {
      const auto symbol = ucum_symbol(vertical_unit);
      json.string(symbol.empty() ? vertical_unit : symbol);
    }
    json.end_array();
  }
  if (!query.formats.empty()) {
    json.key("output_formats");
    write_strings(json, query.formats);
    json.key("default_output_format").string(query.formats.front());
  }
  json.end_object().end_object().end_object();
}

/// What OGC API EDR wants of a collection.
void write_queries(JsonWriter& json, const CollectionDocument& collection) {
  json.key("data_queries").begin_object();
  for (const DataQuery& query : collection.queries) write_data_query(json, query, collection.vertical_unit);
  json.end_object();
  json.key("output_formats");
  write_strings(json, collection.formats);
  json.key("parameter_names").begin_object().key("elevation");
  write_elevation_parameter(json, collection.vertical_unit);
  json.end_object();
}

void write_collection(JsonWriter& json, const CollectionDocument& collection) {
  json.begin_object();
  json.key("id").string(collection.id);
  json.key("title").string(collection.title);
  write_if_any(json, "description", collection.description);
  if (collection.bbox) {
    json.key("extent").begin_object().key("spatial").begin_object();
    json.key("bbox").begin_array();
    write_box(json, *collection.bbox);
    json.end_array();
    json.key("crs").string("http://www.opengis.net/def/crs/OGC/1.3/CRS84");
    json.end_object().end_object();
  }
  if (collection.features) {
    json.key("itemType").string("feature");
  } else {
    json.key("layerDataType").string("Coverage");  // GDAL's OAPIF driver takes all others for features
  }
  json.key("crs");
  write_strings(json, collection.crs);
  write_if_any(json, "storageCrs", collection.storage_crs);
  write_queries(json, collection);
  write_links(json, collection.links);
  json.end_object();
}

void write_job(JsonWriter& json, const JobStatus& job) {
  json.begin_object();
  json.key("jobID").string(job.id);
  json.key("processID").string(job.process);
  json.key("type").string("process");
  json.key("status").string(job_state_name(job.state));
  json.key("progress").integer(static_cast<std::uint64_t>(std::clamp(job.progress, 0, 100)));
  write_if_any(json, "created", job.created);
  write_if_any(json, "started", job.started);
  write_if_any(json, "finished", job.finished);
  write_if_any(json, "message", job.message);
  write_links(json, job.links);
  json.end_object();
}

}  // namespace

void write_links(JsonWriter& json, std::span<const Link> links) {
  json.key("links").begin_array();
  for (const Link& link : links) {
    json.begin_object();
    json.key("href").string(link.href);
    json.key("rel").string(link.rel);
    write_if_any(json, "type", link.type);
    write_if_any(json, "title", link.title);
    json.end_object();
  }
  json.end_array();
}

std::string tin_json(const TinDocument& tin, const FileReport* file) {
  JsonWriter json;
  write_tin(json, tin, file);
  return json.take();
}

std::string tin_list_json(const TinList& list) {
  JsonWriter json;
  json.begin_object();
  json.key("tins").begin_array();
  for (const TinDocument& tin : list.tins) write_tin(json, tin);
  json.end_array();
  json.key("numberMatched").integer(list.number_matched);
  json.key("numberReturned").integer(list.tins.size());
  write_links(json, list.links);
  json.end_object();
  return json.take();
}

std::string edit_result_json(std::uint64_t revision, std::span<const VertexId> ids,
                             std::span<const AreaResult> areas) {
  JsonWriter json;
  json.begin_object();
  json.key("revision").integer(revision);
  json.key("results").begin_array();
  for (std::size_t op = 0; !ids.empty() || !areas.empty(); ++op) {
    json.begin_object();
    std::size_t taken = 1;
    if (areas.empty() || areas.front().first != op) {
      json.key("id").integer(ids.front().value());
    } else {
      taken = areas.front().second;
      areas = areas.subspan(1);
      json.key("removed").begin_array();
      for (const VertexId id : ids.first(taken)) json.integer(id.value());
      json.end_array();
    }
    ids = ids.subspan(taken);
    json.end_object();
  }
  json.end_array().end_object();
  return json.take();
}

std::string elevation_json(const ElevationAnswer& answer) {
  JsonWriter json;
  json.begin_object();
  json.key("z");
  answer.z ? json.number(*answer.z) : json.null();
  json.key("triangle");
  if (answer.triangle) {
    json.begin_array();
    for (const VertexId id : *answer.triangle) json.integer(id.value());
    json.end_array();
  } else {
    json.null();
  }
  json.key("revision").integer(answer.revision);
  json.end_object();
  return json.take();
}

std::string elevations_json(std::span<const std::optional<double>> z, std::uint64_t revision) {
  JsonWriter json;
  json.begin_object();
  json.key("z").begin_array();
  for (const std::optional<double>& one : z) one ? json.number(*one) : json.null();
  json.end_array();
  json.key("revision").integer(revision);
  json.end_object();
  return json.take();
}

std::string landing_json(const Landing& landing) {
  JsonWriter json;
  json.begin_object();
  json.key("title").string(landing.title);
  json.key("description").string(landing.description);
  write_links(json, landing.links);
  json.end_object();
  return json.take();
}

std::string conformance_json(std::span<const std::string> classes) {
  JsonWriter json;
  json.begin_object().key("conformsTo");
  write_strings(json, classes);
  json.end_object();
  return json.take();
}

std::string health_json(std::string_view status, std::string_view version) {
  JsonWriter json;
  json.begin_object().key("status").string(status).key("version").string(version).end_object();
  return json.take();
}

std::string collection_json(const CollectionDocument& collection) {
  JsonWriter json;
  write_collection(json, collection);
  return json.take();
}

std::string collections_json(std::span<const CollectionDocument> collections, std::span<const Link> links) {
  JsonWriter json;
  json.begin_object().key("collections").begin_array();
  for (const CollectionDocument& collection : collections) write_collection(json, collection);
  json.end_array();
  write_links(json, links);
  json.end_object();
  return json.take();
}

std::string_view job_state_name(JobState state) {
  switch (state) {
    case JobState::kAccepted:
      return "accepted";
    case JobState::kRunning:
      return "running";
    case JobState::kSuccessful:
      return "successful";
    case JobState::kFailed:
      return "failed";
    case JobState::kDismissed:
      return "dismissed";
  }
  return "failed";
}

std::optional<JobState> job_state(std::string_view name) {
  for (const JobState state : {JobState::kAccepted, JobState::kRunning, JobState::kSuccessful,
                               JobState::kFailed, JobState::kDismissed}) {
    if (job_state_name(state) == name) return state;
  }
  return std::nullopt;
}

std::string job_json(const JobStatus& job) {
  JsonWriter json;
  write_job(json, job);
  return json.take();
}

std::string job_list_json(std::span<const JobStatus> jobs, std::span<const Link> links) {
  JsonWriter json;
  json.begin_object().key("jobs").begin_array();
  for (const JobStatus& job : jobs) write_job(json, job);
  json.end_array();
  write_links(json, links);
  json.end_object();
  return json.take();
}

}  // namespace proto
