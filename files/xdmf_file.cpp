#include "files/xdmf_file.h"

#include <libxml/xmlwriter.h>

#include <cerrno>
#include <fstream>
#include <initializer_list>
#include <new>

#include "cloth/error.h"
#include "files/new_file.h"

namespace toile::files {
namespace {

using Attributes = std::initializer_list<std::pair<const char*, std::string>>;

const xmlChar* xml(const char* text) {
    return reinterpret_cast<const xmlChar*>(text);
}

int write_to_stream(void* stream, const char* data, int size) {
    return static_cast<std::ofstream*>(stream)->write(data, size) ? size : -1;
}

}  // namespace

struct XdmfWriter::Impl {
    explicit Impl(const std::string& path) : file(path), stream(file.partial(), std::ios::binary) {
        writer = xmlNewTextWriter(xmlOutputBufferCreateIO(write_to_stream, nullptr, &stream, nullptr));
        if (!writer) throw std::bad_alloc();
        errno = 0;
        xmlTextWriterSetIndent(writer, 1);
        check(xmlTextWriterStartDocument(writer, nullptr, "UTF-8", nullptr));
        open("Xdmf", {{"Version", "2.2"}});
        open("Domain", {});
        open("Grid", {{"Name", "samples"}, {"GridType", "Collection"}, {"CollectionType", "Temporal"}});
    }
    ~Impl() { xmlFreeTextWriter(writer); }

    void check(int outcome) const {
        if (outcome >= 0 && stream) return;
        throw Error("cannot write the file: " + write_failure(errno != 0 ? errno : EIO), file.path(),
                    "make room, or write to another disk");
    }
    void open(const char* element, Attributes attributes) {
        check(xmlTextWriterStartElement(writer, xml(element)));
        for (const auto& [key, value] : attributes)
            check(xmlTextWriterWriteAttribute(writer, xml(key), xml(value.c_str())));
    }
    void close() { check(xmlTextWriterEndElement(writer)); }
    void text(const std::string& value) { check(xmlTextWriterWriteString(writer, xml(value.c_str()))); }
    void item(Attributes attributes, const std::string& value) {
        open("DataItem", attributes);
        text(value);
        close();
    }
    void slab(const XdmfArray& array, int64_t row, int64_t rows, int64_t vertices);

    NewFile file;
    std::ofstream stream;
    xmlTextWriterPtr writer = nullptr;
};

/// One row of a dataset (rows, vertices, 3).
void XdmfWriter::Impl::slab(const XdmfArray& array, int64_t row, int64_t rows, int64_t vertices) {
    const std::string columns = std::to_string(vertices) + " 3";
    open("DataItem", {{"ItemType", "HyperSlab"}, {"Dimensions", columns}});
    // VTK's reader tells by the first thing in here whether a mesh is still that of the time before: no blank, then.
    check(xmlTextWriterWriteComment(writer, xml((array.dataset + "[" + std::to_string(row) + "]").c_str())));
    item({{"Dimensions", "3 3"}, {"NumberType", "Int"}, {"Format", "XML"}},
         std::to_string(row) + " 0 0 1 1 1 1 " + columns);
    item({{"Dimensions", std::to_string(rows) + " " + columns},
          {"NumberType", "Float"},
          {"Precision", "4"},
          {"Format", "HDF"}},
         array.file + ":" + array.dataset);
    close();
}

XdmfWriter::XdmfWriter(const std::string& path) : impl_(std::make_unique<Impl>(path)) {}
XdmfWriter::~XdmfWriter() = default;

void XdmfWriter::begin_sample(const std::string& name, int64_t time) {
    impl_->open("Grid", {{"Name", name}, {"GridType", "Collection"}, {"CollectionType", "Spatial"}});
    impl_->open("Time", {{"Value", std::to_string(time)}});
    impl_->close();
}

void XdmfWriter::add_mesh(const XdmfMesh& mesh, int64_t row,
                          const std::vector<std::pair<std::string, int64_t>>& number) {
    Impl& impl = *impl_;
    impl.open("Grid", {{"Name", mesh.name}, {"GridType", "Uniform"}});
    const std::string triangles = std::to_string(mesh.triangles);
    impl.open("Topology", {{"TopologyType", "Triangle"}, {"NumberOfElements", triangles}});
    impl.item({{"Dimensions", triangles + " 3"}, {"NumberType", "Int"}, {"Precision", "4"}, {"Format", "HDF"}},
              mesh.triangle.file + ":" + mesh.triangle.dataset);
    impl.close();
    impl.open("Geometry", {{"GeometryType", "XYZ"}});
    impl.slab(mesh.position, row, mesh.rows, mesh.vertices);
    impl.close();
    for (const auto& [name, array] : mesh.attribute) {
        impl.open("Attribute", {{"Name", name}, {"AttributeType", "Vector"}, {"Center", "Node"}});
        impl.slab(array, row, mesh.rows, mesh.vertices);
        impl.close();
    }
    for (const auto& [name, value] : number) {
        impl.open("Attribute", {{"Name", name}, {"AttributeType", "Scalar"}, {"Center", "Grid"}});
        impl.item({{"Dimensions", "1"}, {"NumberType", "Int"}, {"Format", "XML"}}, std::to_string(value));
        impl.close();
    }
    impl.close();
}

void XdmfWriter::end_sample() {
    impl_->close();
}

void XdmfWriter::commit() {
    errno = 0;
    impl_->check(xmlTextWriterEndDocument(impl_->writer));
    impl_->check(xmlTextWriterFlush(impl_->writer));
    impl_->stream.close();
    impl_->check(0);
    impl_->file.commit();
}

}  // namespace toile::files
