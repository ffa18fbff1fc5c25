// report_page.html as bytes of the program; evaluate/report_page.h hands them out.
    .section .rodata
    .global toile_report_page_begin
    .global toile_report_page_end
toile_report_page_begin:
    .incbin TOILE_REPORT_PAGE
toile_report_page_end:
    .section .note.GNU-stack, "", %progbits
